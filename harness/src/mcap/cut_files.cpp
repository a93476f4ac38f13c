#include "cut_files.h"

#include <sys/mman.h>
#include <unistd.h>
#include <csignal>

#include <array>
#include <atomic>
#include <mutex>

namespace rehearse::mcap {
namespace {

/// Read by a signal handler: nothing but atomics.
struct Watched {
  std::atomic<std::uintptr_t> begin{0};  // 0: free
  std::atomic<std::size_t> size{0};
  std::atomic<bool> cut{false};
};

std::array<Watched, 256> watched;
std::mutex changing;
struct sigaction outside {};  // as it was before ours
std::uintptr_t page_size = 0;

Watched* find(std::uintptr_t address) {
  for (Watched& file : watched) {
    const std::uintptr_t begin = file.begin.load(std::memory_order_acquire);
    if (begin != 0 && begin <= address && address < begin + file.size.load(std::memory_order_acquire)) return &file;
  }
  return nullptr;
}

/// Puts a page of zeros where the file has none any more; any other fault is for whoever handled it before.
void survive(int signal_number, siginfo_t* info, void* context) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (Watched* file = find(address)) {
    void* page = reinterpret_cast<void*>(address / page_size * page_size);
    if (::mmap(page, page_size, PROT_READ, MAP_PRIVATE | MAP_FIXED | MAP_ANONYMOUS, -1, 0) == page) {
      file->cut.store(true, std::memory_order_release);
      return;
    }
  }
  if ((outside.sa_flags & SA_SIGINFO) != 0) return outside.sa_sigaction(signal_number, info, context);
  if (outside.sa_handler != SIG_DFL && outside.sa_handler != SIG_IGN) return outside.sa_handler(signal_number);
  ::sigaction(SIGBUS, &outside, nullptr);  // the fault repeats
}

void install() {
  page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = survive;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
  ::sigaction(SIGBUS, &action, &outside);
}

}  // namespace

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

void end_watch(Bytes mapped) {
  const std::scoped_lock lock(changing);
  if (Watched* file = find(reinterpret_cast<std::uintptr_t>(mapped.data()))) file->begin.store(0);
}

bool was_cut(Bytes mapped) {
  const Watched* file = find(reinterpret_cast<std::uintptr_t>(mapped.data()));
  return file != nullptr && file->cut.load(std::memory_order_acquire);
}

}  // namespace rehearse::mcap
