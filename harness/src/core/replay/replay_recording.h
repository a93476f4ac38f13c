// The replay of a recording that is open already.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <functional>

namespace rehearse {

/// The treatment of a recording that is cut or damaged.
enum class Damage {
  refuse,    // the replay fails, unless the damage is after the replayed part
  tolerate,  // the replay ends at the first missing tick; the report's remarks contain the damage
};

/// Replays like replay(). `scenario`: the recording's scenario.
Result<ReplayReport> replay_recording(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                      Damage damage = Damage::refuse);

/// As replay(). `run` gets the part that calls the controllers, when the recording is open, and returns its result.
Result<ReplayReport> replay_by(
    const std::filesystem::path& trace, const ReplayOptions& options,
    const std::function<Result<ReplayReport>(const std::function<Result<ReplayReport>()>& part)>& run);

}  // namespace rehearse
