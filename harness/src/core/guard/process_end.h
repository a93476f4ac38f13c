// The end of a process that has run controllers: exit() runs the exit handlers and static destructors of libraries that
// stay in memory, as those with an inline variable do.
//
// This code of a controller is guarded as its calls are: a crash, an end of the process and the limit of time end the
// process with the status that exit() was called with, and a warning names the controller. The supervisor is told
// before that code runs, so it needs no more of the process than its end.
#pragma once

#include <string>

namespace rehearse {

/// Must be called before code of a controller is loaded: the libraries in memory belong to the program. Further calls
/// have no effect.
void note_own_libraries();
/// True from that call on.
bool has_loaded_guests();
/// True if code was loaded since that call. Takes no lock.
bool is_code_of_guest(const void* place);

/// Must be called when handlers and destructors of a controller may be left for exit(): its library was unloaded, or
/// has to stay. Those that were registered before are guarded. `controller`: "BODY/NAME". `limit`: of all of them [s].
void guard_process_end(const std::string& controller, double limit);

/// Must be called in a process that was forked to run controllers, before it does.
void note_forked_run();
/// Ends that process: runs what its controllers have left, and nothing that belongs to the program.
[[noreturn]] void end_forked_run();

/// True in the part of exit() that is guarded.
bool is_process_ending();

/// Returns unless is_process_ending(). Then it ends the process and prints a warning with the controller and `deed`:
/// "called _exit(5)". Null: it exceeded the limit. May be called in a signal handler.
void end_if_ending(const char* deed);

/// True if a leak checker is in the process: at its end it may change the exit status.
bool checks_leaks();

}  // namespace rehearse
