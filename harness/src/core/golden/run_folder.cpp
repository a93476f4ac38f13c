#include "run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "base/hashing.h"
#include "base/write_hint.h"
#include "golden_files.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = ".run-";

int open_folder(const fs::path& folder) { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }

/// Removes folders of runs that ended without removing them: their lock is free.
void remove_left_behind(const fs::path& parent) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (fs::directory_iterator entry(parent, ignored), end; !ignored && entry != end; entry.increment(ignored))
    if (entry->path().filename().string().starts_with(prefix)) folders.push_back(entry->path());
  for (const fs::path& folder : folders) {
    const FileDescriptor descriptor(open_folder(folder));
    if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, ignored);
  }
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

bool same_content(const fs::path& a, const fs::path& b) {
  const auto one = hash_of_file(a), other = hash_of_file(b);
  return one && other && *one == *other;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  descriptor_ = FileDescriptor(open_folder(folder));
  if (descriptor_ >= 0)
    while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) continue;
}

Result<RunFolder> RunFolder::make(const fs::path& parent) {
  constexpr int most_tries = 100;  // the last run to end removes an empty parent folder
  for (int tries = 1;; ++tries) {
    const FolderLock lock(parent);
    remove_left_behind(parent);
    std::string path = (parent / fmt::format("{}XXXXXX", prefix)).string();
    if (::mkdtemp(path.data()) != nullptr) {
      const int descriptor = open_folder(path);
      if (descriptor >= 0) ::flock(descriptor, LOCK_EX);
      return RunFolder(path, descriptor);
    }
    if (errno != ENOENT || tries == most_tries)
      return error(fmt::format("can't make a folder in {}: {}", parent.string(), std::strerror(errno)),
                   write_hint(path, "name another folder with REHEARSE_PENDING"));
  }
}

RunFolder::RunFolder(RunFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), descriptor_(std::move(other.descriptor_)) {}

RunFolder::~RunFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (!path_.empty()) ::rmdir(path_.parent_path().c_str());
}

WaitingRun::WaitingRun(const RunFolder& folder, const std::string& name)
    : folder_(folder.path()),
      pending_(folder_.parent_path()),
      trace_(pending_ / (name + ".mcap")),
      before_(FileIdentity::of(trace_)) {}

WaitingRun::~WaitingRun() {
  std::vector<fs::path> left;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder_, ignored), end; !ignored && entry != end; entry.increment(ignored))
    left.push_back(entry->path());
  for (const fs::path& file : left) fs::remove_all(file, ignored);
}

Result<std::string> WaitingRun::publish(std::string& text) {
  const FolderLock lock(pending_);
  const bool written_meanwhile = FileIdentity::of(trace_) != before_;
  std::error_code failed;
  std::string told;
  const fs::path ours = folder() / trace_.filename();
  if (written_meanwhile && fs::exists(ours, failed) && fs::exists(trace_, failed) && !same_content(trace_, ours))
    told = fmt::format("another run has written other bits to {} during this run; this run has replaced them",
                       trace_.string());
  if (!written_meanwhile || fs::exists(ours, failed))
    for (const fs::path& old : {trace_, pending_ / "plant" / trace_.filename()}) remove_run(old);
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(folder(), failed), end; !failed && entry != end; entry.increment(failed))
    if (entry->is_regular_file()) files.push_back(entry->path().lexically_relative(folder()));
  std::stable_partition(files.begin(), files.end(), [&](const fs::path& file) { return file != trace_.filename(); });
  for (const fs::path& file : files) {  // the trace last: then all its files are there
    fs::create_directories((pending_ / file).parent_path(), failed);
    fs::rename(folder() / file, pending_ / file, failed);
    if (failed) return error(fmt::format("{} can't be kept: {}", (pending_ / file).string(), failed.message()));
  }
  replace_all(text, folder().string() + "/", pending_.string() + "/");
  return told;
}

}  // namespace rehearse
