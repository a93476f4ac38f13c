// Supervisor: a parent process that tells how the process with the controllers ended.
//
// A controller can end its process past all that survives it: by a system call, a resource limit, memory that it
// damaged. Nothing in that process can report this. So the process that runs controllers is a child of one that waits
// for it, and notes in memory that both share which controller is called. An end that was not announced is a failed
// controller.
#pragma once

#include <cstdint>
#include <filesystem>

namespace rehearse {

/// In the place of a function.
inline constexpr const char* loading = "loaded";
inline constexpr const char* unloading = "unloaded";

/// A call into a controller begins; ends. `limit`: of the call [s]. Without a parent they do nothing.
void note_call_begin(const char* controller, const char* function, std::int64_t tick, double time, double limit);
void note_call_end();

/// The recording that is being written; empty: none.
void note_recording(const std::filesystem::path& file);

/// The process is about to end with this exit status, as its program wants it to.
void announce_end(int status);

}  // namespace rehearse
