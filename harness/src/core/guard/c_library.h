// The C library past the replacements of its functions in process_tripwires.cpp.
#pragma once

namespace rehearse {

/// True if code of a controller reaches the replacements. It doesn't in a program that loads the C library before this
/// one.
bool replaces_functions();

/// Ends the process, without the functions that exit() would call.
[[noreturn]] void leave_process(int status);

}  // namespace rehearse
