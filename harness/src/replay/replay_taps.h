// What parts of ours want to know of a replay beyond its report.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

struct ReplayTaps {
  /// A recording that is cut or damaged is replayed up to where something is missing; the report's remarks say so.
  bool tolerates_damage = false;
  /// The controllers, BODY/NAME, whose library or options aren't those that were recorded.
  std::vector<std::string> other_controllers;
};

/// replay() of a recording that is open, with its scenario.
Result<ReplayReport> replay(mcap::Reader& trace, const Scenario& scenario, const ReplayOptions& options,
                            ReplayTaps& taps);

}  // namespace rehearse
