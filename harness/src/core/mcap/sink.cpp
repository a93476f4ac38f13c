#include "sink.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "base/file_descriptor.h"
#include "base/write_hint.h"
#include "codec.h"

namespace rehearse::mcap {

namespace {

/// Device and inode; zeros for a file that isn't open.
std::pair<std::uint64_t, std::uint64_t> identity_of(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

/// True if its bytes can be read again: an ordinary file, opened for reading too.
bool can_be_read(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && (::fcntl(file, F_GETFL) & O_ACCMODE) == O_RDWR;
}

}  // namespace

Sink::Sink(int file, std::filesystem::path place)
    : file_(file), place_(std::move(place)), readable_(can_be_read(file)), identity_(identity_of(file)) {}

bool Sink::is_our_file() const { return identity_of(file_) == identity_; }

Result<void> Sink::write(Bytes bytes) {
  if (!bytes.empty() && !is_our_file())
    return error(std::string(closed_by_others),
                 "the data written before are whole; does a controller close a file that it hasn't opened?");
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int cause = errno;
      return error(fmt::format("can't write the trace: {}", std::strerror(cause)),
                   cause == ENOSPC || cause == EDQUOT
                       ? fmt::format("make room on the disk {}, or name another file with -o", disk_of(place_).string())
                       : "");
    }
    crc_ = crc32(bytes.first(static_cast<std::size_t>(written)), crc_);
    size_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> Sink::verify() {
  if (!readable_) return {};
  const auto changed = [](std::string how) {
    return error("something else has " + how + " the trace while it was written",
                 "a controller can do this to all files of its user");
  };
  struct stat status {
  }, named{};
  if (::fstat(file_, &status) != 0 || status.st_nlink == 0) return changed("deleted");
  if (::stat(place_.c_str(), &named) != 0 || named.st_dev != status.st_dev || named.st_ino != status.st_ino)
    return changed("replaced or renamed");
  if (static_cast<std::uint64_t>(status.st_size) != size_)
    return changed(status.st_size < static_cast<off_t>(size_) ? "cut" : "appended to");
  std::vector<std::byte> block(std::size_t{1} << 20);
  std::uint32_t crc = 0;
  for (std::uint64_t offset = 0; offset < size_;) {
    const Bytes::size_type count = std::min<std::uint64_t>(block.size(), size_ - offset);
    REHEARSE_TRY(read_back(offset, std::span(block).first(count)));
    crc = crc32(Bytes(block).first(count), crc);
    offset += count;
  }
  return crc == crc_ ? Result<void>() : changed("written into");
}

Result<void> Sink::read_back(std::uint64_t offset, std::span<std::byte> target) {
  while (!target.empty()) {
    const ssize_t got = is_our_file() ? ::pread(file_, target.data(), target.size(), static_cast<off_t>(offset)) : 0;
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return error(fmt::format("can't read the written part of the trace: {}", std::strerror(errno)));
    if (got == 0) return error("can't read the written part of the trace: it is missing");
    offset += static_cast<std::uint64_t>(got);
    target = target.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

Result<void> Sink::close() {
  if (file_ < 0) return {};
  const bool ours = is_our_file();
  const int file = std::exchange(file_, -1);
  if (ours && ::close(file) != 0) return error(fmt::format("can't finish writing the trace: {}", std::strerror(errno)));
  return {};
}

namespace {

/// Locks out other writers until the descriptor is closed. False: another writer exists. True if files can't be locked.
bool lock(int file) { return ::flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

/// The existing ordinary file of that name, locked against other writers.
class FileThere {
 public:
  explicit FileThere(const std::filesystem::path& file) {
    struct stat opened {
    }, there{};
    if (::stat(file.c_str(), &there) != 0 || !S_ISREG(there.st_mode)) return;
    descriptor_ = FileDescriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor_ < 0) return;
    const bool locked = lock(descriptor_);
    const bool stands = ::fstat(descriptor_, &opened) == 0 && ::stat(file.c_str(), &there) == 0 &&
                        opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
    being_written_ = !locked || !stands;
  }

  bool being_written() const { return being_written_; }
  void release() { descriptor_ = FileDescriptor(); }

 private:
  FileDescriptor descriptor_;
  bool being_written_ = false;
};

/// Replaces a file with one name that belongs to this user by a new, empty file; -1 for other files, or if it can't be
/// replaced.
int replace(const std::filesystem::path& file) {
  struct stat old {};
  if (::lstat(file.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return -1;
  if (old.st_nlink != 1 || old.st_uid != ::geteuid() || ::access(file.c_str(), W_OK) != 0) return -1;
  std::string name = file.string() + ".XXXXXX";
  const int opened = ::mkostemp(name.data(), O_CLOEXEC);
  if (opened < 0) return -1;
  struct stat now {};
  if (lock(opened) && ::fchmod(opened, old.st_mode & 07777) == 0 && ::fstat(opened, &now) == 0 &&
      now.st_gid == old.st_gid && ::rename(name.c_str(), file.c_str()) == 0)
    return opened;
  ::close(opened);
  ::unlink(name.c_str());
  return -1;
}

/// Creates the file, or opens the existing one. An ordinary file is opened for reading too, if that is allowed.
int create(const std::filesystem::path& file) {
  constexpr int flags = O_CREAT | O_CLOEXEC;
  struct stat there {};
  const bool ordinary = ::stat(file.c_str(), &there) != 0 || S_ISREG(there.st_mode);
  const int opened = ordinary ? ::open(file.c_str(), O_RDWR | flags, 0666) : -1;
  return opened >= 0 ? opened : ::open(file.c_str(), O_WRONLY | flags, 0666);
}

mode_t mode_of(int descriptor) {
  struct stat opened {};
  return ::fstat(descriptor, &opened) == 0 ? opened.st_mode : 0;
}

}  // namespace

Result<std::unique_ptr<Sink>> Sink::open(const std::filesystem::path& file) {
  const auto refuse = [&](std::string why, std::string hint = {}) {
    return error_in(file.string(), std::move(why), std::move(hint));
  };
  const auto other_writer = [&] { return refuse("another writer has opened this file", "name another file, or wait"); };
  FileThere there(file);
  if (there.being_written()) return other_writer();
  std::error_code none;
  std::filesystem::path place = std::filesystem::canonical(file, none);  // resolves links
  int opened = none ? -1 : replace(place);
  const bool is_new = opened >= 0;  // it replaces the existing file, and is locked
  there.release();
  if (!is_new) opened = create(file);
  if (opened < 0)
    return refuse(fmt::format("can't create the trace: {}", std::strerror(errno)),
                  write_hint(file, "name another file with -o"));
  std::unique_ptr<Sink> sink(new Sink(opened, none ? std::filesystem::absolute(file) : place));
  const bool keeps_bytes = S_ISREG(mode_of(opened));  // unlike a device as /dev/null, to which any number may write
  if (!is_new && keeps_bytes && !lock(opened)) return other_writer();
  if (!is_new && keeps_bytes && ::ftruncate(opened, 0) != 0)
    return refuse(fmt::format("can't empty the trace: {}", std::strerror(errno)));
  return sink;
}

}  // namespace rehearse::mcap
