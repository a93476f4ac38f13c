// Replacements of the C library's functions that close descriptors: those of the run stay open in code of a controller.
#include <errno.h>
#include <stdio.h>
#include <unistd.h>

#include <algorithm>

#include "cost_counter.h"
#include "guarded_call.h"
#include "next_functions.h"
#include "process_guard.h"
#include "turn_calls.h"

namespace {

using rehearse::HostCode;
using rehearse::ProcessGuard;

bool keeps(int descriptor) {
  const HostCode own;
  return (rehearse::in_guarded_call() || rehearse::own_threads) && ProcessGuard::instance().keeps(descriptor);
}

}  // namespace

extern "C" {

int close(int descriptor) {
  if (keeps(descriptor)) return errno = EBADF, -1;
  rehearse::note_turn_close(descriptor);
  return REHEARSE_NEXT(close)(descriptor);
}

int dup2(int from, int to) noexcept {
  if (from != to && keeps(to)) return errno = EBUSY, -1;
  return REHEARSE_NEXT(dup2)(from, to);
}

int dup3(int from, int to, int flags) noexcept {
  if (from != to && keeps(to)) return errno = EBUSY, -1;
  return REHEARSE_NEXT(dup3)(from, to, flags);
}

int fclose(FILE* stream) {
  if (rehearse::in_guarded_call() && stream && keeps(fileno(stream))) {
    fflush(stream);
    return errno = EBADF, EOF;
  }
  return REHEARSE_NEXT(fclose)(stream);
}

int close_range(unsigned int first, unsigned int last, int flags) noexcept {
  if (!rehearse::in_guarded_call() || flags != 0) return REHEARSE_NEXT(close_range)(first, last, flags);
  unsigned int from = first;
  for (const unsigned int kept : ProcessGuard::instance().kept_in(first, last)) {
    if (kept > from && REHEARSE_NEXT(close_range)(from, kept - 1, 0) != 0) return -1;
    from = kept + 1;
  }
  return from <= last ? REHEARSE_NEXT(close_range)(from, last, 0) : 0;
}

void closefrom(int first) noexcept {
  if (!rehearse::in_guarded_call()) return REHEARSE_NEXT(closefrom)(first);
  close_range(static_cast<unsigned int>(std::max(first, 0)), ~0U, 0);
}

}  // extern "C"
