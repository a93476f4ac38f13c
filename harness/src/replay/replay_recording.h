// The replay of a recording that is open already.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

namespace rehearse {

/// What becomes of the replay of a recording that is cut or damaged.
enum class Damage {
  refuse,    // it fails, unless the damage is behind the part that is replayed
  tolerate,  // it ends where something is missing; the report's remarks say so
};

/// As replay(). `scenario` is that of the recording.
Result<ReplayReport> replay_recording(mcap::Reader& recording, const Scenario& scenario, const ReplayOptions& options,
                                      Damage damage = Damage::refuse);

}  // namespace rehearse
