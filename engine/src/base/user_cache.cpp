#include "user_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

namespace rehearse {

namespace fs = std::filesystem;

namespace {

/// Notes that the file is used. A day is as exact as it needs to be, and saves most writes.
void note_use(const fs::path& file) {
  std::error_code failed;
  const auto now = fs::file_time_type::clock::now();
  const auto before = fs::last_write_time(file, failed);
  if (!failed && now - before > std::chrono::hours(24)) fs::last_write_time(file, now, failed);
}

/// Removes files of the folder, the one that was used longest ago first, until its files have `most` bytes. Other
/// processes may do the same.
void bound_folder(const fs::path& folder, std::uintmax_t most) {
  struct Used {
    fs::file_time_type at;
    fs::path file;
    std::uintmax_t size;
  };
  std::vector<Used> files;
  std::uintmax_t sum = 0;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    std::error_code gone;
    Used used{entry->last_write_time(gone), entry->path(), 0};
    if (!gone && entry->is_regular_file(gone)) used.size = entry->file_size(gone);
    if (gone || used.size == 0) continue;
    sum += used.size;
    files.push_back(std::move(used));
  }
  if (sum <= most) return;
  std::ranges::sort(files, {}, [](const Used& used) { return std::tie(used.at, used.file); });
  for (const Used& used : files) {
    if (sum <= most) return;
    fs::remove(used.file, failed);
    sum -= used.size;
  }
}

}  // namespace

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
  note_use(file);
  return std::move(text).str();
}

void keep_in_cache(const fs::path& file, std::string_view bytes, std::uintmax_t bound) {
  if (bytes.size() > bound) return;
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  const fs::path whole = fs::path(file).concat(fmt::format(".{}", getpid()));
  std::ofstream stream(whole, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (stream) fs::rename(whole, file, failed);
  if (!stream || failed)
    fs::remove(whole, failed);
  else
    bound_folder(file.parent_path(), bound);
}

}  // namespace rehearse
