// System calls that are made past the C library.
#pragma once

#include <stdint.h>

namespace rehearse::interposer {

/// Takes the signal by which they are told of. Before the first controller.
void prepare_for_system_calls();

/// From now on the system calls in a library's code come to us first, by SIGSYS; if it holds any. False: it does, but
/// the kernel doesn't allow it.
bool watch_system_calls(uint64_t begin, uint64_t end);

}  // namespace rehearse::interposer
