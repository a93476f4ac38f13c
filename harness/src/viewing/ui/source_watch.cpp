#include "source_watch.h"

#include <fmt/format.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "base/hashing.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t watched_events =
    IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_CREATE | IN_DELETE | IN_ONLYDIR | IN_EXCL_UNLINK;

/// Folders that programs fill.
bool is_made(const std::string& name) {
  return name.starts_with("build") || name == "target" || name == "__pycache__" || name == "node_modules";
}

/// Hidden files, and those that editors write beside the one that is edited.
bool is_no_source(const std::string& name) { return name.starts_with('.') || name.ends_with('~') || name == "4913"; }

}  // namespace

SourceWatch::SourceWatch(fs::path folder, std::set<fs::path> without, int descriptor)
    : folder_(std::move(folder)), without_(std::move(without)), descriptor_(descriptor) {}

Result<SourceWatch> SourceWatch::open(fs::path folder, std::set<fs::path> without) {
  const int descriptor = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (descriptor < 0) return error(fmt::format("changes of files can't be watched: {}", strerror(errno)));
  SourceWatch watch(std::move(folder), std::move(without), descriptor);
  REHEARSE_TRY(watch.watch(watch.folder_));
  return watch;
}

bool SourceWatch::is_left_out(const fs::path& folder) const {
  const std::string name = folder.filename().string();
  return name.starts_with('.') || is_made(name) || without_.contains(folder);
}

Result<void> SourceWatch::watch(const fs::path& folder) {
  const int number = ::inotify_add_watch(descriptor_, folder.c_str(), watched_events);
  if (number < 0 && errno == ENOSPC)
    return error_in(folder.string(), "the kernel watches no more folders for this user",
                    "sysctl fs.inotify.max_user_watches states how many it does");
  if (number < 0) return {};  // it is gone again, or nobody may read it
  folders_[number] = folder;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    std::error_code unknown;
    if (!entry->is_directory(unknown) || entry->is_symlink(unknown) || is_left_out(entry->path())) continue;
    REHEARSE_TRY(watch(entry->path()));
  }
  return {};
}

bool SourceWatch::has_new_content(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    contents_.erase(file);
    return true;
  }
  const auto hash = hash_of_file(file);
  if (!hash) return true;
  const auto [known, is_first] = contents_.try_emplace(file, *hash);
  return is_first || std::exchange(known->second, *hash) != *hash;
}

std::vector<fs::path> SourceWatch::changed() {
  std::set<fs::path> files;
  alignas(inotify_event) std::array<char, 65536> block;
  for (;;) {
    const ssize_t size = ::read(descriptor_, block.data(), block.size());
    if (size <= 0) break;
    for (const char* place = block.data(); place < block.data() + size;) {
      const auto& event = *reinterpret_cast<const inotify_event*>(place);
      place += sizeof(inotify_event) + event.len;
      if ((event.mask & IN_Q_OVERFLOW) != 0) files.insert(folder_);
      if ((event.mask & IN_IGNORED) != 0) folders_.erase(event.wd);
      const auto folder = folders_.find(event.wd);
      if (event.len == 0 || folder == folders_.end() || is_no_source(event.name)) continue;
      const fs::path path = folder->second / event.name;
      if ((event.mask & IN_ISDIR) != 0 && is_left_out(path)) continue;
      const bool is_there = (event.mask & (IN_DELETE | IN_MOVED_FROM)) == 0;
      if ((event.mask & IN_ISDIR) != 0) {
        // files may have come into a new folder before its watch, or have gone with a folder
        if (is_there && !watch(path)) files.insert(folder_);
        files.insert(path);
      } else if ((event.mask & IN_CREATE) != 0) {
        created_.insert(path);  // it counts when it is closed
      } else if (!is_there && created_.erase(path) > 0) {
        files.erase(path);  // a temporary file
      } else {
        files.insert(path);
      }
    }
  }
  std::erase_if(files, [&](const fs::path& file) { return file != folder_ && !has_new_content(file); });
  return {files.begin(), files.end()};
}

}  // namespace rehearse
