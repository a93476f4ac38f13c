// The replays of an audit: the varied factor of each, and the replay that it is compared with.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <vector>

#include "replay_process.h"

namespace rehearse {

/// One varied factor, and the replays under it.
struct Experiment {
  Factor factor = Factor::nothing;
  std::string not_varied;  // why there are no replays
  std::vector<ReplaySettings> settings;
};

/// The settings of a plain replay: the real clock, the system's random numbers, unchanged memory and addresses. With
/// virtualise: simulated time and seeded random numbers.
ReplaySettings plain_replay(const AuditOptions& options);

/// The settings of a still replay, in which all controllable conditions are constant: simulated time, seeded random
/// numbers, filled memory, the same addresses. Experiments are compared with it.
ReplaySettings still_replay(const AuditOptions& options);

/// The experiments to make, given the observed calls of controllers. A factor that no call asked for is not varied. If
/// `unseen` is true, controllers can make unobserved calls, and all factors are varied.
std::vector<Experiment> plan_experiments(const AuditOptions& options, const std::vector<ObservedCall>& calls,
                                         bool unseen);

/// The still replay with one place whose calls get different answers. The source of the call must be the clock, random
/// numbers or the machine.
ReplaySettings other_answer_at(const AuditOptions& options, const ObservedCall& call, int number);

}  // namespace rehearse
