// What a scenario says otherwise than the recording it is compared with, where that alone decides what can be compared.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <optional>
#include <string>

namespace rehearse {

/// Two runs whose ticks have other lengths have no tick in common. None: the time step is the recorded one.
std::optional<Divergence> changed_time_step(const Scenario& scenario, const Trace& recording);

/// The last tick that both runs have, if one is longer than the other. None: the duration is the recorded one.
std::optional<Divergence> changed_duration(const Scenario& scenario, const Trace& recording);

/// The first controller that only one of the two has, in a sentence. Empty: both have the same, by BODY/NAME.
std::string changed_controllers(const Scenario& scenario, const Trace& recording);

}  // namespace rehearse
