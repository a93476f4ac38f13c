// BranchSource: the recording from which a branch starts, and its facts.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scenario/branch_origin.h"
#include "recorded_checkpoints.h"

namespace rehearse {

struct BranchSource {
  std::unique_ptr<mcap::Reader> reader;
  Trace recording;                     // without messages, which stay in the file
  Scenario scenario;                   // with the models' meshes
  std::optional<BranchOrigin> origin;  // none: it is no branch itself
  std::int64_t whole_ticks = 0;        // number of complete ticks in the recording, at least one
  /// `scenario_file`: the recorded scenario, for its meshes; empty: the recording is sufficient if there are no meshes.
  /// Fails if that is a different scenario, if meshes are missing, or if no simulation can continue from the recording.
  static Result<BranchSource> open(const std::filesystem::path& file, const std::filesystem::path& scenario_file);

  /// Between the recording's checkpoints [ticks]; 0: none are saved.
  std::int64_t checkpoint_interval(const RecordedCheckpoints& checkpoints) const;
  /// The hash of the state at the beginning of a whole tick, or after the last; none: it isn't recorded.
  std::optional<std::uint64_t> state_hash(std::int64_t tick) const;
};

}  // namespace rehearse
