// Replay: recorded inputs into the controllers, without physics and without a renderer; their commands compared with
// the recorded ones, bit for bit. That they are fed with what was recorded is checked by the hash of all inputs in each
// tick, as long as they read the same things as then.
//
// The controllers run from the beginning of the recording: their own memory is part of what is replayed. The libraries
// may be others than those recorded. Links neither ODE nor OSMesa.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/divergence.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// One word of what the controllers give in a tick.
struct OutputField {
  enum class Kind {
    number,  // the bits of a double
    flag,    // 0 or 1: whether it takes part, what control() returned, whether a device was told anything
  };
  std::string controller;  // "SR1/SR1Minimum"
  std::string channel;     // topic, as in a recording
  std::string element;     // within it: RLEG_KNEE/u
  std::string unit;        // may be empty
  Kind kind = Kind::number;
};

struct ReplayOptions : HostOptions {
  double from = 0.0;            // commands before it are not compared [s]
  std::optional<double> until;  // the replay ends there [s]
  /// How far a command may be from the recorded one and still count as within; empty: not asked, no command may.
  std::optional<std::vector<ToleranceRule>> tolerances;
  /// Called with each difference, in the order of ticks; null: not.
  std::function<void(const Divergence&)> on_difference;
  /// Called once, when the controllers have started, with what on_outputs will be given; null: not.
  std::function<void(const std::vector<OutputField>&)> on_started;
  /// Called after each tick with a word for each of those fields; null: not.
  std::function<void(std::int64_t tick, const std::vector<std::uint64_t>&)> on_outputs;
  /// Called about every hundredth of the recording with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct ReplayReport {
  std::int64_t ticks = 0;            // replayed
  std::int64_t ticks_different = 0;  // in which any command differed
  std::int64_t values = 0;           // numbers compared
  std::int64_t values_different = 0;
  std::optional<Divergence> first;    // in the order of ticks, controllers, links
  std::optional<Divergence> worst;    // by absolute difference
  std::optional<Divergence> beyond;   // the first beyond ReplayOptions::tolerances; without them, the first
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung; the replay ended there
  bool controller_refused = false;
  bool same_controllers = false;  // every controller's file is, byte by byte, the one that was recorded; so are options
  Diagnostics remarks;

  bool equal() const { return !first && !failure; }
  bool within() const { return !beyond && !failure; }
};

/// Fails if the trace can't be read or holds no recording of ours, if a library doesn't load, or if a controller reads
/// something that was not recorded.
Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options = {});

}  // namespace rehearse
