// Own processes: calls that run controllers, each in a process that has run no controller.
//
// Such a process is a fork of this one, which has loaded our libraries and no guest. It has the supervisor of this
// process: a recording goes there, and a failed controller is reported by it, as if this process had made the call.
#pragma once

#include <rehearse/diagnostic.h>

#include <functional>
#include <string>

#include "answer.h"

namespace rehearse {

/// From now on call_in_own_process() forks. Without a supervisor, as under a debugger, it has no effect.
void begin_own_processes();

/// Calls `work` in a fork and returns its answer; before begin_own_processes(), and in such a fork, it only calls it.
/// A fork that a controller ends lets this process end in the same way. Fails if no process can be started.
Result<std::string> call_in_own_process(const std::function<std::string()>& work);

/// True if call_in_own_process() forks.
bool has_own_processes();

/// True if it forks, and such a fork has run no controller: this process has loaded none.
bool begin_without_guests();

/// Calls `make` in such a process and passes its result on.
template <class Outcome>
Result<Outcome> in_own_process(const std::function<Result<Outcome>()>& make) {
  if (!has_own_processes()) return make();
  const auto text = REHEARSE_TRY(call_in_own_process([&make] { return packed_result(make()); }));
  return unpacked_result<Outcome>(text);
}

}  // namespace rehearse
