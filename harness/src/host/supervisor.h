// Supervisor: a parent process that reports how the process with the controllers ended.
//
// A controller can end its process in ways that the process itself can't handle: by a system call, a resource limit,
// damaged memory. Nothing in that process can report this. So the process that runs controllers is the child of a
// waiting parent; it notes in shared memory which controller is called. An end that was not announced is a failed
// controller.
#pragma once

#include <cstdint>
#include <filesystem>

namespace rehearse {

/// Used in the place of a function.
inline constexpr const char* loading = "loaded";
inline constexpr const char* unloading = "unloaded";

/// Report the begin and the end of a call into a controller. `limit`: of the call [s]. Without a parent they have no
/// effect.
void note_call_begin(const char* controller, const char* function, std::int64_t tick, double time, double limit);
void note_call_end();

/// Sets the recording that is being written; empty: none.
void note_recording(const std::filesystem::path& file);

/// Announces that the process will regularly end with this exit status.
void announce_end(int status);

}  // namespace rehearse
