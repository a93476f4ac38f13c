#include "file_view.h"

#include "base/temporary_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace rehearse::mcap {

Diagnostic Input::unreadable(std::string_view why, std::string hint) const {
  return error_in(name_, fmt::format("can't read the trace: {}", why), std::move(hint));
}

Result<Input> Input::open(const std::filesystem::path& file) {
  const bool standard = file == "-";
  const int opened = standard ? ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0) : ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const int problem = errno;
  Input input(opened, standard ? "standard input" : file.string());
  if (opened < 0) {
    std::error_code ignored;
    if (problem == ENXIO && std::filesystem::is_socket(file, ignored))
      return input.unreadable("it is a socket's file", "- reads standard input");
    return input.unreadable(std::strerror(problem));
  }
  REHEARSE_TRY(input.look());
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

Result<std::size_t> Input::read(std::span<std::byte> target) {
  while (true) {
    const ssize_t came = ::read(descriptor_, target.data(), target.size());
    if (came >= 0) return static_cast<std::size_t>(came);
    if (errno == EAGAIN) {  // another process made this standard input non-blocking
      pollfd wait{descriptor_, POLLIN, 0};
      ::poll(&wait, 1, -1);
    } else if (errno != EINTR) {
      return unreadable(std::strerror(errno));
    }
  }
}

namespace {

/// Read by a signal handler, so it has only atomics.
struct Watched {
  std::atomic<std::uintptr_t> begin{0};  // 0: free
  std::atomic<std::size_t> size{0};
  std::atomic<bool> cut{false};
};

std::array<Watched, 256> watched;
std::mutex changing;
struct sigaction outside {};  // the previous handler
std::uintptr_t page_size = 0;

Watched* find_watched(std::uintptr_t address) {
  for (Watched& file : watched) {
    const std::uintptr_t begin = file.begin.load(std::memory_order_acquire);
    if (begin != 0 && begin <= address && address < begin + file.size.load(std::memory_order_acquire)) return &file;
  }
  return nullptr;
}

/// Maps a page of zeros where the file is truncated; passes any other fault to the previous handler.
void survive(int signal_number, siginfo_t* info, void* context) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (Watched* file = find_watched(address)) {
    void* page = reinterpret_cast<void*>(address / page_size * page_size);
    if (::mmap(page, page_size, PROT_READ, MAP_PRIVATE | MAP_FIXED | MAP_ANONYMOUS, -1, 0) == page) {
      file->cut.store(true, std::memory_order_release);
      return;
    }
  }
  if ((outside.sa_flags & SA_SIGINFO) != 0) return outside.sa_sigaction(signal_number, info, context);
  if (outside.sa_handler != SIG_DFL && outside.sa_handler != SIG_IGN) return outside.sa_handler(signal_number);
  ::sigaction(SIGBUS, &outside, nullptr);  // the access is repeated, and the previous handler gets its fault
}

void install() {
  page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = survive;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
  ::sigaction(SIGBUS, &action, &outside);
}

/// Registers mapped bytes, so that reading them survives a truncation of the file.
void watch_for_cut(Bytes mapped) {
  static std::once_flag installed;
  std::call_once(installed, install);
  const std::scoped_lock lock(changing);
  for (Watched& file : watched) {
    if (file.begin.load() != 0) continue;
    file.cut.store(false);
    file.size.store(mapped.size());
    file.begin.store(reinterpret_cast<std::uintptr_t>(mapped.data()), std::memory_order_release);
    return;
  }
}

/// Must be called before they are unmapped.
void end_watch(Bytes mapped) {
  const std::scoped_lock lock(changing);
  if (Watched* file = find_watched(reinterpret_cast<std::uintptr_t>(mapped.data()))) file->begin.store(0);
}

Diagnostic failure(const std::string& name, std::string_view what, int problem) {
  return error_in(name, fmt::format("can't {}: {}", what, std::strerror(problem)));
}

/// Stores the input to its end.
Result<std::shared_ptr<const TemporaryFile>> keep(Input& input) {
  const auto kept = std::make_shared<TemporaryFile>();
  const std::string keeping = fmt::format("store the input in {}", kept->folder());
  if (kept->descriptor() < 0) return failure(input.name(), keeping, errno);
  std::vector<std::byte> piece(std::size_t{1} << 18);
  while (true) {
    const auto came = REHEARSE_TRY(input.read(piece));
    if (came == 0) return std::shared_ptr<const TemporaryFile>(kept);
    if (!kept->append(Bytes(piece).first(came))) return failure(input.name(), keeping, errno);
  }
}

/// Stores the input of a pipe that can be read once: opening it again returns the stored bytes.
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

bool was_cut(Bytes mapped) {
  const Watched* file = find_watched(reinterpret_cast<std::uintptr_t>(mapped.data()));
  return file != nullptr && file->cut.load(std::memory_order_acquire);
}

Result<FileView> FileView::open(const std::filesystem::path& file) {
  if (const std::filesystem::path folder = folder_of(file); !folder.empty()) return open_folder(folder);
  auto input = REHEARSE_TRY(Input::open(file));
  auto kept = std::shared_ptr<const TemporaryFile>();
  if (input.mappable_size() == 0) {
    kept = REHEARSE_TRY(keep_for_all(input));
  }
  auto view = kept ? map(kept->descriptor(), kept->size(), input.name())
                   : map(input.descriptor(), input.mappable_size(), input.name());
  if (!view) return view;
  const Container container = container_of(view->bytes());
  const ContainerReader* reader = container_reader();
  const bool is_other =
      container == Container::sqlite || container == Container::zstd || container == Container::ros1_bag;
  if (!reader || !is_other) return view;
  const std::filesystem::path path = kept ? std::filesystem::path(kept->path()) : file;
  auto converted = REHEARSE_TRY(reader->convert_file(container, view->bytes(), view->name(), path));
  return map_converted(converted, view->name());
}

Result<FileView> FileView::open_folder(const std::filesystem::path& path) {
  const std::string name = (path.has_filename() ? path : path.parent_path()).string();  // without a / at its end
  const ContainerReader* reader = container_reader();
  if (!reader) return error_in(name, "can't read the trace: it is a directory");
  const auto folder = REHEARSE_TRY(reader->open_folder(path, name));
  return folder.only_file.empty() ? map_converted(folder.converted, name) : open(folder.only_file);
}

Result<FileView> FileView::map_converted(const ConvertedPtr& converted, const std::string& name) {
  auto view = map(converted->file->descriptor(), converted->file->size(), name);
  if (view) view->converted_ = converted;
  return view;
}

Result<FileView> FileView::map(int descriptor, std::uint64_t size, const std::string& name) {
  FileView view;
  view.name_ = name;
  if (size == 0) return view;
  void* place = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (place == MAP_FAILED) return failure(name, "read the trace", errno);
  view.bytes_ = Bytes(static_cast<const std::byte*>(place), size);
  watch_for_cut(view.bytes_);
  view.mapping_ = std::shared_ptr<void>(place, [mapped = view.bytes_](void* begin) {
    end_watch(mapped);
    ::munmap(begin, mapped.size());
  });
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

}  // namespace rehearse::mcap
