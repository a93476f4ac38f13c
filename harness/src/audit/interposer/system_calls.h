// System calls past the C library.
#pragma once

#include <stdint.h>
#include <time.h>

namespace rehearse::interposer {

/// Installs the handler of SIGSYS, which observed system calls raise. Must be called before the first controller.
void prepare_for_system_calls();

/// Sleeps in real time, past all replacements.
void sleep_really(const timespec& duration);

/// From now on the system calls in a library's code, if it contains any, raise SIGSYS and are handled here. False: it
/// contains some, but the kernel doesn't allow the filter.
bool watch_system_calls(uint64_t begin, uint64_t end);

}  // namespace rehearse::interposer
