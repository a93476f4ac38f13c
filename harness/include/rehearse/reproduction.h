// Reproduction: whether a recording repeats itself, here and now. Neither its golden nor tolerances have a say: bits.
//
// The controllers are fed with its inputs again, from the first tick to the last, and have to give its commands. From
// some of its checkpoints the world goes on under its commands, each time until the next checkpoint, and has to give the
// same state, sensors and pictures. So a recording of ten minutes is tried in seconds. What a controller reads beside its
// inputs may still be the same by accident; `rehearse audit` goes to the bottom of that.
#pragma once

#include <rehearse/check.h>
#include <rehearse/diagnostic.h>
#include <rehearse/divergence.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace rehearse {

struct ReproductionOptions : HostOptions {
  int spans = 5;  // of simulation, from one checkpoint to the next, evenly over the recording; the first and last included
  /// Called about every hundredth with what is done and all of it; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct Reproduction {
  std::string verdict;               // one sentence, without a full stop
  std::optional<Divergence> first;   // of what came out otherwise: a command, or else what the world did
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung, or the simulation exploded
  std::int64_t replayed = 0;         // ticks whose commands were repeated
  std::int64_t simulated = 0;        // ticks of simulation
  int spans = 0;

  bool reproduced() const { return !first && !failure; }
};

/// Tries a recording of this scenario as it is now. What the world does meanwhile is written to `scratch` and removed.
/// Of a recording without usable checkpoints the whole simulation is run again. Fails if a run can't begin.
Result<Reproduction> reproduce(const Scenario& scenario, const Trace& recording, const std::filesystem::path& scratch,
                               const ReproductionOptions& options, const Simulation& simulation);

/// The first place, in the order of time, where `part` says something that `whole` doesn't say at that time, bit for bit.
/// What only `whole` says is not asked; nor are hashes of inputs and outputs, which a run without controllers lacks.
Result<std::optional<Divergence>> first_not_in(const Trace& whole, const Trace& part);

}  // namespace rehearse
