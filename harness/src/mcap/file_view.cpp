#include "file_view.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

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
    std::error_code ignored;
    folder_ = std::filesystem::temp_directory_path(ignored).string();
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
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) return false;
      if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
  }
  int descriptor() const { return descriptor_; }
  const std::string& folder() const { return folder_; }

 private:
  int descriptor_ = -1;
  std::string folder_;
};

}  // namespace

Result<FileView> FileView::open(const std::filesystem::path& file) {
  auto input = Input::open(file);
  if (!input) return input.errors();
  if (input->mappable_size() == 0) return keep(*input);
  return map(input->descriptor(), input->mappable_size(), input->name());
}

Result<FileView> FileView::keep(Input& input) {
  TemporaryFile kept;
  const std::string keeping = fmt::format("keep what comes in {}", kept.folder());
  if (kept.descriptor() < 0) return failure(input.name(), keeping, errno);
  std::vector<std::byte> piece(std::size_t{1} << 18);
  std::uint64_t size = 0;
  while (true) {
    const auto came = input.read(piece);
    if (!came) return came.errors();
    if (*came == 0) return map(kept.descriptor(), size, input.name());
    if (!kept.append(Bytes(piece).first(*came))) return failure(input.name(), keeping, errno);
    size += *came;
  }
}

Result<FileView> FileView::map(int descriptor, std::uint64_t size, const std::string& name) {
  FileView view;
  view.name_ = name;
  if (size == 0) return view;
  void* place = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (place == MAP_FAILED) return failure(name, "read the trace", errno);
  view.bytes_ = Bytes(static_cast<const std::byte*>(place), size);
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
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

FileView::FileView(FileView&& other) noexcept
    : bytes_(std::exchange(other.bytes_, {})), name_(std::move(other.name_)) {}

FileView& FileView::operator=(FileView&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(name_, other.name_);
  return *this;
}

}  // namespace rehearse::mcap
