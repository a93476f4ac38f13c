// BranchSource: the recording that a branch begins with, and what is known of it.
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

#include "scenario/branch_origin.h"

namespace rehearse {

struct BranchSource {
  std::unique_ptr<mcap::Reader> reader;
  Trace recording;
  Scenario scenario;                   // with the models' meshes
  std::optional<BranchOrigin> origin;  // none: it is no branch itself
  std::int64_t whole_ticks = 0;        // that the recording has, at least one
  /// Of the state at the beginning of each of them and of the one after the last, if the recording has that.
  std::vector<std::uint64_t> state_hashes;

  /// `scenario_file`: the scenario that was recorded, for its meshes; empty: the recording is enough if there are none.
  /// Fails if that is another scenario, if meshes are missing, or if no simulation can go on from the recording.
  static Result<BranchSource> open(const std::filesystem::path& file, const std::filesystem::path& scenario_file);

  std::int64_t checkpoint_interval() const;  // [ticks]; 0: none are saved
  /// The latest checkpoint from which the world can be led to the moment so that all of it is known there; 0: the
  /// start. `objection`: why none can be used; empty: they can.
  std::int64_t latest_checkpoint(std::int64_t moment, const std::string& objection) const;
};

}  // namespace rehearse
