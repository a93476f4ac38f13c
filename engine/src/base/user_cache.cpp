#include "user_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

namespace rehearse {

namespace fs = std::filesystem;

fs::path user_cache() {
  const auto folder = [](const char* variable) {
    const char* value = std::getenv(variable);
    return fs::path(value ? value : "");
  };
  if (const fs::path stated = folder("REHEARSE_CACHE"); !stated.empty()) return stated == "off" ? fs::path() : stated;
  if (const fs::path caches = folder("XDG_CACHE_HOME"); caches.is_absolute()) return caches / "rehearse";
  if (const fs::path home = folder("HOME"); home.is_absolute()) return home / ".cache/rehearse";
  return {};
}

std::optional<std::string> read_from_cache(const fs::path& file) {
  std::error_code failed;
  if (fs::is_directory(file, failed)) {
    static auto& told = *new std::set<fs::path>;
    if (told.insert(file).second)
      fmt::print(stderr,
                 "warning: {} is a folder, where a file of the cache belongs: it stays, and nothing is kept there\n",
                 file.string());
    return std::nullopt;
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) return std::nullopt;
  return std::move(text).str();
}

void keep_in_cache(const fs::path& file, std::string_view bytes) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  const fs::path whole = fs::path(file).concat(fmt::format(".{}", getpid()));
  std::ofstream stream(whole, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) fs::rename(whole, file, failed);
  if (!stream || failed) fs::remove(whole, failed);
}

}  // namespace rehearse
