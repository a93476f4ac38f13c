#include "file_view.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "cut_files.h"
#include "input.h"

namespace rehearse::mcap {

namespace {

Diagnostic failure(const std::string& name, std::string_view what, int problem) {
  Diagnostic diagnostic = error(fmt::format("can't {}: {}", what, std::strerror(problem)));
  diagnostic.file = name;
  return diagnostic;
}

/// A file without a name that goes with its descriptor.
class TemporaryFile {
 public:
  TemporaryFile() {
    std::error_code none;
    folder_ = std::filesystem::temp_directory_path(none).string();
    if (none) {
      folder_ = "the folder for temporary files";
      errno = none.value();
      return;
    }
    descriptor_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor_ >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT)) return;
    std::string name = folder_ + "/rehearse.XXXXXX";  // not every file system has nameless ones
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ >= 0) ::unlink(name.c_str());
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool append(Bytes bytes) {
    size_ += bytes.size();
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) return false;
      if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }
  int descriptor() const { return descriptor_; }
  std::uint64_t size() const { return size_; }
  const std::string& folder() const { return folder_; }

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::string folder_;
};

/// All that comes, to its end.
Result<std::shared_ptr<const TemporaryFile>> keep(Input& input) {
  const auto kept = std::make_shared<TemporaryFile>();
  const std::string keeping = fmt::format("keep what comes in {}", kept->folder());
  if (kept->descriptor() < 0) return failure(input.name(), keeping, errno);
  std::vector<std::byte> piece(std::size_t{1} << 18);
  while (true) {
    const auto came = input.read(piece);
    if (!came) return came.errors();
    if (*came == 0) return std::shared_ptr<const TemporaryFile>(kept);
    if (!kept->append(Bytes(piece).first(*came))) return failure(input.name(), keeping, errno);
  }
}

/// The same of a pipe that gives its bytes once: whoever opens it again gets what came the first time.
Result<std::shared_ptr<const TemporaryFile>> keep_for_all(Input& input) {
  static std::mutex mutex;
  static std::map<std::uint64_t, std::shared_ptr<const TemporaryFile>> all;
  if (!input.only_once()) return keep(input);
  const std::scoped_lock lock(mutex);
  const auto found = all.find(*input.only_once());
  if (found != all.end()) return found->second;
  auto kept = keep(input);
  if (kept) all[*input.only_once()] = *kept;
  return kept;
}

}  // namespace

Result<FileView> FileView::open(const std::filesystem::path& file) {
  auto input = Input::open(file);
  if (!input) return input.errors();
  if (input->mappable_size() > 0) return map(input->descriptor(), input->mappable_size(), input->name());
  const auto kept = keep_for_all(*input);
  if (!kept) return kept.errors();
  return map((*kept)->descriptor(), (*kept)->size(), input->name());
}

Result<FileView> FileView::map(int descriptor, std::uint64_t size, const std::string& name) {
  FileView view;
  view.name_ = name;
  if (size == 0) return view;
  void* place = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (place == MAP_FAILED) return failure(name, "read the trace", errno);
  view.bytes_ = Bytes(static_cast<const std::byte*>(place), size);
  watch_for_cut(view.bytes_);
  return view;
}

void FileView::forget(Bytes part) const {
  if (bytes_.empty() || part.data() < bytes_.data() || part.data() + part.size() > bytes_.data() + bytes_.size())
    return;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t begin = static_cast<std::size_t>(part.data() - bytes_.data()) / page * page;
  const std::size_t end = static_cast<std::size_t>(part.data() + part.size() - bytes_.data());
  ::madvise(const_cast<std::byte*>(bytes_.data()) + begin, end - begin, MADV_DONTNEED);
}

FileView::~FileView() {
  if (bytes_.empty()) return;
  end_watch(bytes_);
  ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

FileView::FileView(FileView&& other) noexcept
    : bytes_(std::exchange(other.bytes_, {})), name_(std::move(other.name_)) {}

FileView& FileView::operator=(FileView&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(name_, other.name_);
  return *this;
}

}  // namespace rehearse::mcap
