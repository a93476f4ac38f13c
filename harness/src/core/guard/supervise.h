// Supervision: a process that runs controllers never ends without a verdict, even if a controller ends it.
#pragma once

#include <functional>
#include <string>

namespace rehearse {

/// Must be called in main() after pin_process(), before there are threads. The program continues in a child process.
/// This process waits for it, passes signals on and ends with its exit status. A controller may end the child past the
/// C library: by a system call, a resource limit, damaged memory. Then this process reports the controller and the
/// tick, closes the recordings and ends with exit status 3. It has no effect under a debugger or valgrind, which
/// would not follow the program, or if the environment has REHEARSE_SUPERVISE=off.
void supervise_process();

/// From now on the supervisor also calls this with its sentence about a failed controller, before it ends; null:
/// nothing.
void on_failed_process(std::function<void(const std::string& sentence)> tell);

/// Memory that this process frees stays with it from now on, and with those that it forks: to give it back interrupts
/// the other processors, and to take it again costs page faults. Tens of megabytes are given back all the same.
void keep_freed_memory();

/// Sets the present task of the program for that report, as "test Walk.IsAsBefore", and the number of remaining tasks.
void note_task(const char* name, int left);

/// True if a debugger, or another tracer as strace, traces the process. Allocates nothing and takes no lock, because
/// the code that hangs may hold any, including that of the dynamic linker.
bool is_traced(const char* status_file = "/proc/self/status");

}  // namespace rehearse
