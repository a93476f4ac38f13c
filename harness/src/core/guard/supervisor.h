// Supervisor: a parent process that reports how the process with the controllers ended.
//
// A controller can end its process in ways that the process itself can't handle: by a system call, a resource limit,
// damaged memory. Nothing in that process can report this. So the process that runs controllers is the child of a
// parent that writes its recordings (keeper/). The child notes in shared memory which controller is called. An end that
// was not announced is a failed controller: the parent closes the recordings with that failure.
#pragma once

#include <sys/types.h>

#include <cstdint>

namespace rehearse {

/// Used in the place of a function.
inline constexpr const char* loading = "loaded";
inline constexpr const char* unloading = "unloaded";
inline constexpr const char* destroying = "destroyed";  // static objects, at the end of the process

/// Report the begin and the end of a call into a controller. `limit`: of the call [s]. Without a parent they have no
/// effect.
void note_call_begin(const char* controller, const char* function, std::int64_t tick, double time, double limit);
void note_call_end();

/// The process ends if it takes more memory [bytes]; 0: four fifths of the memory that was available at its start.
void note_memory_limit(double bytes);

/// Note a crash, and its place, for the case that the process can't report it, as with a damaged heap. The next call
/// that begins deletes the note. `deed`: after the controller's name, "crashed: ..."; `place`: the address of the
/// controller's code, or null if it isn't known. They are called in signal handlers.
void note_crash(const char* deed);
void note_crash_place(const void* place);

/// Ends the process because a controller's call failed in a way that leaves the process unusable: `deed` after the
/// controller's name, "crashed: ..."; null: it exceeded its limit. Returns if there is no parent to report it. They are
/// called in signal handlers. `place`: the address of the controller's code; null: it isn't known.
void fail_process(const char* deed, const void* place = nullptr);
/// The same for a failure of a thread that a controller started.
void fail_process_by_thread(const char* deed, const void* place = nullptr);

/// Announces that the process will regularly end with this exit status.
void announce_end(int status);

/// True if this process has a supervisor.
bool is_supervised();

/// Forks this process for a run. Unlike other forks it has the supervisor of this process: its calls are noted, and its
/// recordings are sent there. It ends with this process. As fork().
pid_t fork_run();
/// Waits for the end of that process. Returns it as waitpid().
int end_of_run(pid_t run);
/// Its result is there, however it ended: no call of a controller is running. Names a controller that ended it in
/// exit().
void note_result_of_run(int ended);
/// True if this is the process of the present run, a child of this one.
bool is_own_run(pid_t process);
/// Ends this process in the same way, without announcing it.
[[noreturn]] void end_as(int ended);

}  // namespace rehearse
