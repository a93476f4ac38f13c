// Replay: feeds recorded inputs to the controllers, without physics and without a renderer, and compares their commands
// with the recorded commands, bit for bit. In each tick the hash of all inputs is compared with the recorded hash, as
// long as the controllers read the same quantities as in the recording.
//
// The controllers run from the beginning of the recording, because their memory is part of the replay. The libraries
// may differ from the recorded libraries. Links neither ODE nor OSMesa.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

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

/// One word (64 bits) of the outputs of the controllers in a tick.
struct OutputField {
  std::string controller;  // "SR1/SR1Minimum"
  std::string channel;     // topic, as in a recording
  std::string element;     // within the channel: RLEG_KNEE/u
  std::string unit = {};   // may be empty
  /// A double, or a boolean: whether the controller takes part, the result of control(), whether a device was
  /// commanded.
  CellKind kind = CellKind::floating;
};

/// The replayed part of a recording, changes of its inputs, and callbacks for the outputs.
struct ReplayOptions : HostOptions {
  double from = 0.0;            // commands before this time are not compared [s]
  std::optional<double> until;  // end of the replay [s]
  /// Controllers find the recorded copies of files that are missing here. False: they see this machine as it is.
  bool provides_files = true;
  /// Inputs that are altered before the controllers see them, each as SERIES=VALUE@SPAN:
  /// Walker/KNEE/q=0.3@tick:1200..1300 (src/replay/altered_inputs.h describes the forms). Differences then show the
  /// reaction of the controllers.
  std::vector<std::string> set;
  /// The allowed difference of a command from the recorded command, for ReplayReport::within(); none: the tolerances of
  /// the recording's scenario.
  std::optional<std::vector<ToleranceRule>> tolerances;
  /// Called with each difference, in the order of ticks; null: never called.
  std::function<void(const Divergence&)> on_difference;
  /// Called with the first different line of a tick, and with each different variable that no rule names, after the
  /// commands of that tick; null: never called.
  std::function<void(const Divergence&)> on_word;
  /// Called once, when the controllers have started, with the fields that on_outputs will report; null: never called.
  std::function<void(const std::vector<OutputField>&)> on_started;
  /// Called after each tick with one word for each of those fields; null: never called.
  std::function<void(std::int64_t tick, const std::vector<std::uint64_t>&)> on_outputs;
  /// Called with each variable that a controller set in a tick (rehearse_variable.h), after on_outputs; null: never
  /// called. `series` as in a recording: SR1/Walker/variable/phase.
  std::function<void(std::int64_t tick, const std::string& series, double value)> on_variable;
  /// Called after each tick, if threads of controllers take turns, with a sentence for each: "threads.cpp:88: 'planner'
  /// waits for a condition"; null: never called.
  std::function<void(std::int64_t tick, const std::vector<std::string>&)> on_threads;
  /// Called with each event of the replay when it happens, and with each line of a controller (severity note, the
  /// controller is the source); null: never called. Events of initialize() and start() have tick 0.
  std::function<void(const msg::Event&)> on_event;
  /// Called about every hundredth of the recording with the number of replayed ticks and the number of all ticks; null:
  /// never called.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// Outputs of the controllers beside their commands: lines to os(), and variables. They do not influence the verdict,
/// except variables that a tolerance rule of the recording's scenario names: these are compared like commands.
struct ReplayedWords {
  std::int64_t lines = 0;           // number of compared lines
  std::int64_t variables = 0;       // number of compared numbers of variables
  std::int64_t different = 0;       // ticks with different lines, and variables with different bits
  std::optional<Divergence> first;  // the first different number of a variable
};

/// Differences of commands, in the order of ticks, controllers, links.
struct ReplayReport : Differences {
  int controllers = 0;               // number of controllers that were fed
  std::int64_t ticks = 0;            // number of replayed ticks
  std::int64_t ticks_different = 0;  // number of ticks with a different command
  /// All commands have the recorded bits, or are within a rule that is written for commands (scenario.h); refusals in
  /// control() are within the ticks that their rules allow.
  bool commands_hold = true;
  /// Inputs that only the recorded controllers read ("- Rig/Gyro"), or only these ("+ Rig/Gyro"). Then the inputs can't
  /// be compared as a whole, and commands alone are.
  std::vector<std::string> other_inputs;
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung; the replay ended there
  ReplayedWords words;                // the outputs beside commands
  /// How the controllers' variables relate to the recorded ones, if commands differ: "the scale differs: speed is 20
  /// times the recorded one, in all 300 values". One sentence; empty: no relation was found.
  std::string explanation;
  /// Of a robot's flight: why this process may compute other last bits than the robot's loop: "the loop's processor has
  /// avx2 fma, and this one avx". Empty: it computes with the same functions, or the recording is no flight.
  std::string other_mathematics;
  bool controller_refused = false;  // a controller that isn't optional refused to take part; the replay ended
  /// BODY/NAME of the controllers whose library differs from the recorded library in any byte.
  std::vector<std::string> other_controllers;
  /// Files beside the recording that a controller reads now, or read during the recording, and whose content has
  /// changed: a sentence each.
  std::vector<std::string> changed_files;
  /// Every controller's file equals the recorded file, byte by byte; options are equal, too.
  bool same_controllers = false;
  /// The first tick whose hash of inputs or outputs differs from the recorded hash; nullopt: no hash differs.
  std::optional<std::int64_t> first_other_hash;
  /// Nothing that the controllers read, did or wrote distinguishes this replay from the whole recording: the hashes of
  /// inputs and outputs in all ticks, the channels that a recording would have, commands, lines, variables and events.
  bool repeats_the_run = false;
  Diagnostics remarks;                      // about libraries, warnings of controllers
  std::vector<ControlTimes> control_times;  // of the controllers that took part

  /// All commands have the recorded bits.
  bool equal() const { return !first && !failure; }
  /// All commands are within their tolerances.
  bool within() const { return !beyond && !failure; }
  /// Not all commands have the recorded bits, and rules that are written for commands allow it.
  bool is_allowed() const { return first && commands_hold && within(); }
  /// Not all commands have the recorded bits, and other mathematics explains it: all are within their tolerances.
  bool is_rounding() const { return first && within() && !other_mathematics.empty(); }
};

/// One sentence: the series that leaves its tolerance first, "differs at" and a place, that commands change within
/// tolerance, or, if no number is more than a thousand ULPs off, that only bits differ. Empty: all commands are equal.
/// The second form begins with the words `before_differs`, the others with `before_beyond`.
std::string headline(const ReplayReport& replayed, const std::string& before_beyond = {},
                     const std::string& before_differs = {});

/// Replays a recording. Fails if the trace can't be read or isn't a recording of Rehearse, if a library doesn't load,
/// or if a controller reads a quantity that was not recorded.
Result<ReplayReport> replay(const std::filesystem::path& trace, const ReplayOptions& options = {});

/// Writes the replay of a recording as a new recording. It contains the recorded observations, the controllers' inputs
/// with the alterations of ReplayOptions::set, and their new outputs. It covers the whole recording, independent of
/// `from` and `until`.
Result<void> write_replay(const std::filesystem::path& recording, const std::filesystem::path& trace,
                          const ReplayOptions& options);

}  // namespace rehearse
