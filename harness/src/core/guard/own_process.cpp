#include "own_process.h"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>

#include "base/file_descriptor.h"
#include "base/hashing.h"
#include "c_library.h"
#include "guarded_call.h"
#include "interruption.h"
#include "process_end.h"
#include "process_guard.h"
#include "supervise.h"
#include "supervisor.h"

namespace rehearse {
namespace {

bool forks = false;

/// Before an answer in its file. A guest may write there.
struct AnswerHead {
  std::uint64_t size = 0;  // of the answer [bytes]
  std::uint64_t hash = 0;
  std::uint64_t failed = 0;  // 1: it is the message of an exception
};

bool write_all(int file, const void* data, std::size_t size, std::size_t at) {
  for (const char* next = static_cast<const char*>(data); size > 0;) {
    const ssize_t written = ::pwrite(file, next, size, static_cast<off_t>(at));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    next += written;
    at += static_cast<std::size_t>(written);
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

bool read_all(int file, void* data, std::size_t size, std::size_t at) {
  return ::pread(file, data, size, static_cast<off_t>(at)) == static_cast<ssize_t>(size);
}

/// In the fork.
[[noreturn]] void answer(int file, const std::function<std::string()>& work) noexcept {
  ProcessGuard::instance().protect(file, "the answer of its process");
  AnswerHead head;
  std::string text;
  try {
    text = work();
  } catch (const std::exception& problem) {
    text = problem.what();
    head.failed = 1;
  }
  std::fflush(nullptr);
  end_if_reader_is_gone();
  head.size = text.size();
  head.hash = hash_bytes(text.data(), text.size());
  const bool is_whole =
      write_all(file, text.data(), text.size(), sizeof head) && write_all(file, &head, sizeof head, 0);
  if (!is_whole) leave_process(EXIT_FAILURE);
  end_forked_run();
}

bool take_answer(int file, AnswerHead& head, std::string& text) {
  if (!read_all(file, &head, sizeof head, 0)) return false;
  const off_t size = ::lseek(file, 0, SEEK_END);
  if (size < 0 || head.size != static_cast<std::uint64_t>(size) - sizeof head) return false;
  text.resize(head.size);
  return read_all(file, text.data(), text.size(), sizeof head) && hash_bytes(text.data(), text.size()) == head.hash;
}

}  // namespace

void keep_freed_memory() {
  constexpr int trimmed = 32 << 20, mapped = 8 << 20;  // [bytes]
  mallopt(M_TRIM_THRESHOLD, trimmed);
  mallopt(M_MMAP_THRESHOLD, mapped);
}

void begin_own_processes() {
  forks = is_supervised();
  if (forks) prepare_guarded_calls();  // once, not in each fork
}

bool has_own_processes() { return forks && is_supervised(); }

bool begin_without_guests() { return has_own_processes() && !has_loaded_guests(); }

Result<std::string> call_in_own_process(const std::function<std::string()>& work) {
  if (!has_own_processes()) return work();
  const FileDescriptor file(::memfd_create("answer of a run", MFD_CLOEXEC));
  if (file < 0 || ::ftruncate(file, 0) != 0)
    return error(fmt::format("there is no memory for the answer of a run: {}", std::strerror(errno)));
  const pid_t run = fork_run();
  if (run < 0) return error(fmt::format("no process can be started for a run: {}", std::strerror(errno)));
  if (run == 0) {
    forks = false;
    note_forked_run();
    answer(file, work);
  }
  const int ended = end_of_run(run);
  AnswerHead head;
  std::string text;
  if (!take_answer(file, head, text)) end_as(ended);
  note_result_of_run(ended);
  if (head.failed == 1) throw std::runtime_error(text);
  return text;
}

}  // namespace rehearse
