// Changes of a scenario since its recording that limit the comparison.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <optional>
#include <string>

namespace rehearse {

/// A changed time step: two runs with different time steps have no tick in common. None: the time step is the recorded
/// one.
std::optional<Divergence> changed_time_step(const Scenario& scenario, const Trace& recording);

/// A changed duration, at the last tick that both runs have. None: the duration is the recorded one.
std::optional<Divergence> changed_duration(const Scenario& scenario, const Trace& recording);

/// The first controller that only one of the two has, in a sentence. Empty: both have the same controllers, by
/// BODY/NAME.
std::string changed_controllers(const Scenario& scenario, const Trace& recording);

}  // namespace rehearse
