// The replays of an audit: what is varied in each, and against which other one it is compared.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <vector>

#include "replay_process.h"

namespace rehearse {

/// One change, and the replays under it.
struct Experiment {
  Factor factor = Factor::nothing;
  std::string not_varied;  // why there are no replays
  std::vector<ReplaySettings> settings;
};

/// As it is: the real clock, the system's random numbers, memory and addresses as they come. With virtualise: simulated
/// time and seeded random numbers.
ReplaySettings plain_replay(const AuditOptions& options);

/// All that can be held still is: simulated time, seeded random numbers, painted memory, the same addresses. What
/// experiments are compared with.
ReplaySettings still_replay(const AuditOptions& options);

/// What is to be tried, after the calls that controllers made were seen. What can't matter, since nobody asked for it,
/// is not varied; if `unseen` is true, controllers can ask without being seen, and all is.
std::vector<Experiment> plan_experiments(const AuditOptions& options, const std::vector<ObservedCall>& calls,
                                         bool unseen);

/// The still replay but for one place, whose calls are answered otherwise. It goes by the clock, by random
/// numbers or by the machine.
ReplaySettings other_answer_at(const AuditOptions& options, const ObservedCall& call, int number);

}  // namespace rehearse
