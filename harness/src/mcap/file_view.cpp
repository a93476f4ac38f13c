#include "file_view.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <utility>

namespace rehearse::mcap {

namespace {

Diagnostic unreadable(const std::filesystem::path& file, std::string_view why) {
  Diagnostic diagnostic = error(fmt::format("can't read the trace: {}", why));
  diagnostic.file = file.string();
  return diagnostic;
}

}  // namespace

Result<FileView> FileView::open(const std::filesystem::path& file) {
  const int opened = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (opened < 0) return unreadable(file, std::strerror(errno));
  struct stat status {};
  const bool known = ::fstat(opened, &status) == 0;
  const auto size = static_cast<std::size_t>(status.st_size);
  const bool regular = known && S_ISREG(status.st_mode);
  void* place = regular && size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, opened, 0) : nullptr;
  const int problem = errno;
  ::close(opened);
  if (!regular) return unreadable(file, S_ISDIR(status.st_mode) ? "it is a directory" : "it is not a regular file");
  if (place == MAP_FAILED) return unreadable(file, std::strerror(problem));
  return FileView(Bytes(static_cast<const std::byte*>(place), size));
}

FileView::~FileView() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

FileView::FileView(FileView&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

FileView& FileView::operator=(FileView&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

}  // namespace rehearse::mcap
