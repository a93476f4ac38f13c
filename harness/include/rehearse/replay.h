// Replay: recorded inputs into the controllers, without physics and without a renderer; their commands compared with
// the recorded ones, bit for bit. That they are fed with what was recorded is checked by the hash of all inputs in each
// tick, as long as they read the same things as then.
//
// The controllers run from the beginning of the recording: their own memory is part of what is replayed. The libraries
// may be others than those recorded. Links neither ODE nor OSMesa.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

namespace msg {
struct Event;
}

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
  /// Inputs that are altered before the controllers see them, each as SERIES=VALUE@SPAN:
  /// Walker/KNEE/q=0.3@tick:1200..1300 (src/replay/altered_inputs.h has the forms). What differs then is what they do
  /// of it.
  std::vector<std::string> set;
  /// How far a command may be from the recorded one and still count as within; empty: not asked, no command may.
  std::optional<std::vector<ToleranceRule>> tolerances;
  /// Called with each difference, in the order of ticks; null: not.
  std::function<void(const Divergence&)> on_difference;
  /// Called once, when the controllers have started, with what on_outputs will be given; null: not.
  std::function<void(const std::vector<OutputField>&)> on_started;
  /// Called after each tick with a word for each of those fields; null: not.
  std::function<void(std::int64_t tick, const std::vector<std::uint64_t>&)> on_outputs;
  /// Called with each variable that a controller set in a tick (rehearse_variable.h), after on_outputs; null: not.
  /// `series` as in a recording: SR1/Walker/variable/phase.
  std::function<void(std::int64_t tick, const std::string& series, double value)> on_variable;
  /// Called with each event of the replay as it happens, the controllers' lines among them (severity note, the source
  /// is the controller); null: not. Those of initialize() and start() have tick 0.
  std::function<void(const msg::Event&)> on_event;
  /// Called about every hundredth of the recording with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// What the controllers said beside their commands: lines to os(), and variables. It makes no verdict, but for
/// variables that a tolerance rule of the recording's scenario asks for: these are compared like commands.
struct ReplayedWords {
  std::int64_t lines = 0;      // compared
  std::int64_t variables = 0;  // numbers compared
  std::int64_t different = 0;  // ticks with another line, and variables that aren't the same bits
  std::optional<Divergence> first;
};

/// Differences of commands, in the order of ticks, controllers, links; without ReplayOptions::tolerances none is
/// allowed.
struct ReplayReport : Differences {
  std::int64_t ticks = 0;             // replayed
  std::int64_t ticks_different = 0;   // in which any command differed
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung; the replay ended there
  ReplayedWords words;
  bool controller_refused = false;
  std::vector<std::string> other_controllers;  // BODY/NAME of those whose library isn't, byte by byte, the recorded one
  /// Files beside the recording that the controllers read now, or read when it was made, with other content: a sentence
  /// each.
  std::vector<std::string> changed_files;
  bool same_controllers = false;  // every controller's file is, byte by byte, the one that was recorded; so are options
  Diagnostics remarks;

  bool equal() const { return !first && !failure; }
  bool within() const { return !beyond && !failure; }
};

/// Fails if the trace can't be read or holds no recording of ours, if a library doesn't load, or if a controller reads
/// something that was not recorded.
Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options = {});

/// The replay of a recording as a recording: what was to be seen as it was, the controllers' inputs with what
/// ReplayOptions::set alters of them, and what they did of them. Whole, whatever `from` and `until` say.
Result<void> write_replay(const std::filesystem::path& recording, const std::filesystem::path& trace,
                          const ReplayOptions& options);

}  // namespace rehearse
