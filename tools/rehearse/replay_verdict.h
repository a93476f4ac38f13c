// The verdict on a replay, for all verbs that replay a recording.
#pragma once

#include <rehearse/replay.h>

#include <string>
#include <vector>

#include "output.h"

namespace rehearse::tool {

/// The commands have the recorded bits, or their rules allow the differences, or other mathematics explains them.
bool replay_holds(const ReplayReport& report);

/// "equal bit for bit: 1000 ticks, ...", "differs: ...", "failed: ...".
std::string replay_verdict(const ReplayReport& report);

/// The object of `replay --json`. `notes`: remarks of the command.
Json replay_json(const ReplayReport& report, const std::vector<std::string>& notes);

}  // namespace rehearse::tool
