#include "result_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include "process_guard.h"

namespace rehearse {
namespace {

std::FILE* kept = nullptr;
int kept_descriptor = -1;

}  // namespace

void keep_stdout_for_results() {
  if (kept) return;
  std::fflush(stdout);
  const int descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (descriptor < 0) return;
  kept = fdopen(descriptor, "w");
  if (!kept) {
    close(descriptor);
    return;
  }
  kept_descriptor = descriptor;
  ProcessGuard::instance().protect(descriptor, "stdout");
  dup2(STDERR_FILENO, STDOUT_FILENO);
}

void give_stdout_back() {
  if (!kept) return;
  std::fflush(stdout);
  std::fflush(kept);
  dup2(kept_descriptor, STDOUT_FILENO);
  ProcessGuard::instance().release(kept_descriptor);
  std::fclose(kept);
  kept = nullptr;
  kept_descriptor = -1;
}

std::FILE* result_stream() { return kept ? kept : stdout; }

int result_descriptor() { return kept_descriptor; }

}  // namespace rehearse
