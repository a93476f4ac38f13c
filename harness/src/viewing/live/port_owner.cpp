#include "port_owner.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// Names of the sockets that listen on the port, as descriptors link to them: "socket:[4711]".
std::set<std::string> sockets_on(std::uint16_t port) {
  std::set<std::string> sockets;
  const std::string suffix = fmt::format(":{:04X}", port);
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream file(table);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string number, local, remote, state, queues, timer, retries, user, timeout, inode;
      words >> number >> local >> remote >> state >> queues >> timer >> retries >> user >> timeout >> inode;
      constexpr const char* listening = "0A";
      if (local.ends_with(suffix) && state == listening) sockets.insert(fmt::format("socket:[{}]", inode));
    }
  }
  return sockets;
}

bool has_any(const fs::path& process, const std::set<std::string>& sockets) {
  std::error_code failed;
  for (fs::directory_iterator entry(process / "fd", failed), end; !failed && entry != end; entry.increment(failed)) {
    std::error_code gone;
    if (sockets.contains(fs::read_symlink(entry->path(), gone).string())) return true;
  }
  return false;
}

}  // namespace

std::string owner_of_port(std::uint16_t port) {
  const std::set<std::string> sockets = sockets_on(port);
  std::error_code failed;
  if (!sockets.empty())
    for (fs::directory_iterator entry("/proc", failed), end; !failed && entry != end; entry.increment(failed)) {
      const std::string number = entry->path().filename().string();
      if (number.find_first_not_of("0123456789") != std::string::npos || !has_any(entry->path(), sockets)) continue;
      std::string name;
      std::ifstream comm(entry->path() / "comm");
      std::getline(comm, name);
      return fmt::format("{} (process {})", name, number);
    }
  return "another program";
}

}  // namespace rehearse
