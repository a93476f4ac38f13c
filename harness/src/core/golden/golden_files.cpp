#include "golden_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <rehearse/compare.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "base/write_hint.h"
#include "run_folder.h"
#include "stale_report.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

Diagnostic can_not(const char* what, const fs::path& file, const std::string& why) {
  return error_in(file.string(), fmt::format("can't {}: {}", what, why));
}

/// Waits until a file or folder is stored on the disk.
Result<void> sync(const fs::path& path) {
  const FileDescriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor < 0 || ::fsync(descriptor) != 0) return can_not("be written to disk", path, std::strerror(errno));
  return {};
}

/// A new version of a file beside it. An unfinished draft is removed.
class Draft {
 public:
  explicit Draft(const fs::path& target) : target_(target), file_(target.string() + ".new") {}
  ~Draft() {
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const fs::path& file() const { return file_; }
  Result<void> replace_target() const {
    std::error_code failed;
    fs::rename(file_, target_, failed);
    if (failed) return can_not("be replaced", target_, failed.message());
    return {};
  }

 private:
  fs::path target_;
  fs::path file_;
};

Result<void> write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (!stream) return can_not("be written", file, std::strerror(errno));
  return {};
}

}  // namespace

Result<std::string> read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return can_not("be read", file, std::strerror(errno));
  std::string text;
  std::array<char, 1 << 14> block;
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0)
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  return text;
}

fs::path verdict_file_of(const fs::path& trace) { return fs::path(trace).replace_extension(".verdict"); }

void remove_run(const fs::path& trace) {
  std::error_code ignored;
  fs::remove(trace, ignored);
  fs::remove(verdict_file_of(trace), ignored);
  remove_picture_differences(trace);
  remove_report(trace);
}

namespace {

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

Result<void> sync_folder_of(const fs::path& file) { return sync(folder_of(file)); }

/// Removes drafts of processes that were killed. Must be called with the folder locked: then no other draft is there.
void remove_drafts_left_behind(const fs::path& folder) {
  std::vector<fs::path> drafts;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    for (const std::string_view draft : {".mcap.new", ".mcap.new.samples", ".txt.new", ".noise.new"})
      if (name.ends_with(draft) && entry->is_regular_file(ignored)) drafts.push_back(entry->path());
  }
  for (const fs::path& draft : drafts) fs::remove(draft, ignored);
}

/// Makes the folder of a golden. Fails if the folder can't get new files.
Result<void> prepare_folder_of(const fs::path& golden) {
  std::error_code failed;
  fs::create_directories(folder_of(golden), failed);
  if (!failed && ::access(folder_of(golden).c_str(), W_OK) == 0) return {};
  return error_in(golden.string(),
                  fmt::format("can't be written: {}", failed ? failed.message() : std::strerror(errno)),
                  write_hint(golden, "name another folder with REHEARSE_GOLDEN_DIR"));
}

}  // namespace

Result<void> replace_together(const fs::path& trace, const std::function<Result<void>(const fs::path&)>& write_trace,
                              const fs::path& digest,
                              const std::function<Result<std::string>(const fs::path&)>& make_digest) {
  REHEARSE_TRY(prepare_folder_of(trace));
  const FolderLock alone(folder_of(trace));  // two simultaneous acceptances use the same names of drafts
  remove_drafts_left_behind(folder_of(trace));
  const Draft new_trace(trace), new_digest(digest);
  REHEARSE_TRY(write_trace(new_trace.file()));
  const auto text = REHEARSE_TRY(make_digest(new_trace.file()));
  REHEARSE_TRY(write_text(new_digest.file(), text));
  REHEARSE_TRY(sync(new_trace.file()));
  REHEARSE_TRY(sync(new_digest.file()));
  REHEARSE_TRY(new_trace.replace_target());
  REHEARSE_TRY(new_digest.replace_target());
  return sync_folder_of(trace);
}

Result<void> replace_text(const fs::path& file, const std::string& text) {
  REHEARSE_TRY(prepare_folder_of(file));
  const FolderLock alone(folder_of(file));
  remove_drafts_left_behind(folder_of(file));
  const Draft draft(file);
  REHEARSE_TRY(write_text(draft.file(), text));
  REHEARSE_TRY(sync(draft.file()));
  REHEARSE_TRY(draft.replace_target());
  return sync_folder_of(file);
}

}  // namespace rehearse
