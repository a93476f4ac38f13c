// Partial acceptance: some channels of a run, or some span of its time, into a golden that keeps the rest.
//
// A golden is a recording, and a recording is what some run produced: its commands follow from its inputs, its state
// from its commands, its sensors and pictures from its state. So a part of a run can be accepted only if that stays
// true of what comes of it. How it is decided:
//
// 1. The candidate is the run (its scenario, models and provenance), with the golden's messages on every channel and
//    outside of the span that isn't accepted. The hashes in /tick, checkpoints and transforms follow the stage that
//    they are made of.
// 2. If all that is kept has the same bits in both, the candidate is the run itself, and is accepted whole.
// 3. Otherwise it is executed again, stage by stage: its inputs into the controllers have to give its commands, and its
//    commands into the world, from checkpoint to checkpoint, its state, sensors and pictures; bit for bit.
// 4. Anything else is refused, with the first place where a channel that is kept doesn't follow, and the channels that
//    moved together with it.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/simulation.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// Which part of a run.
struct Selection {
  std::vector<std::string> channels;  // patterns of topics and series, `*` for any text; empty: all
  double from = 0.0;                  // [s]
  std::optional<double> until;        // [s], itself not included

  bool is_all() const { return channels.empty() && from <= 0.0 && !until; }
};

/// "channels /SR1/Eye/*, from 1 s, until 2 s".
std::string to_string(const Selection& selection);

/// What a candidate is executed again with.
struct Reexecution {
  HostOptions host;
  /// session.h: run_plant, from who simulates. Null: only what is the run itself in all that is kept can be accepted.
  RunPlant run_plant;
  /// Files that may be the run's scenario. A recording has no meshes: a run with meshes needs the file that it is of.
  std::vector<std::filesystem::path> scenarios;
};

/// The recording that would become the golden: the run's own file, or `candidate`, which was written. Fails if no run
/// can produce it, or if the selection selects nothing; then nothing is left behind.
Result<std::filesystem::path> make_partial(const Trace& golden, const Trace& run, const Selection& selection,
                                           const std::filesystem::path& candidate, const Reexecution& again);

}  // namespace rehearse
