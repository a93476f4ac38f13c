// Supervision: a process that runs controllers never ends without a verdict, whatever they do to it.
#pragma once

namespace rehearse {

/// To be called in main() behind pin_process(), before there are threads. The program goes on in a child process; this
/// one waits for it, passes signals on and ends with its exit status. If a controller ends the child past the C library
/// (a system call, a resource limit, damaged memory), it reports which one and at which tick, saves what was recorded
/// and ends with exit status 3. Does nothing under a debugger or valgrind, which would lose sight of the program.
void supervise_process();

/// What the program does now, for that report, as "test Walk.IsAsBefore"; and how much of it is left to be done.
void note_task(const char* name, int left);

/// A debugger, or another tracer as strace, looks at the process. Allocates nothing and takes no lock: the code that
/// hangs may hold any, that of the dynamic linker included.
bool is_traced(const char* status_file = "/proc/self/status");

}  // namespace rehearse
