#include "input.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace rehearse::mcap {

Diagnostic Input::unreadable(std::string_view why, std::string hint) const {
  Diagnostic diagnostic = error(fmt::format("can't read the trace: {}", why), std::move(hint));
  diagnostic.file = name_;
  return diagnostic;
}

Result<Input> Input::open(const std::filesystem::path& file) {
  const bool standard = file == "-";
  const int opened = standard ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0) : ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const int problem = errno;
  Input input(opened, standard ? "standard input" : file.string());
  if (opened < 0) {
    std::error_code ignored;
    if (problem == ENXIO && std::filesystem::is_socket(file, ignored))
      return input.unreadable("it is a socket's file", "- reads what comes by standard input");
    return input.unreadable(std::strerror(problem));
  }
  if (auto fine = input.look(); !fine) return fine.errors();
  return input;
}

Result<void> Input::look() {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return unreadable(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) return unreadable("it is a directory");
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) return unreadable("it is a device");
  if (S_ISREG(status.st_mode) && ::lseek(descriptor_, 0, SEEK_CUR) == 0)
    size_ = static_cast<std::uint64_t>(status.st_size);
  struct statfs system {};
  if (S_ISFIFO(status.st_mode) && ::fstatfs(descriptor_, &system) == 0 && system.f_type == PIPEFS_MAGIC)
    only_once_ = status.st_ino;
  return {};
}

Input::~Input() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<std::size_t> Input::read(std::span<std::byte> target) {
  while (true) {
    const ssize_t came = ::read(descriptor_, target.data(), target.size());
    if (came >= 0) return static_cast<std::size_t>(came);
    if (errno == EAGAIN) {  // somebody else's idea of our standard input
      pollfd wait{descriptor_, POLLIN, 0};
      ::poll(&wait, 1, -1);
    } else if (errno != EINTR) {
      return unreadable(std::strerror(errno));
    }
  }
}

}  // namespace rehearse::mcap
