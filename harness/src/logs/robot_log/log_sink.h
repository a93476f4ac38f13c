// LogSink: writes the replay of a log into a trace, and compares its commands with those of the robot's own controller.
#pragma once

#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "command_timing.h"
#include "core/compare/row_judge.h"
#include "core/run/recording_sink.h"
#include "log_memory.h"
#include "log_observations.h"
#include "log_replay.h"

namespace rehearse {

class LogSink final : public RecordingSink {
 public:
  /// `compared_from`: commands before this time of the ticks aren't compared [ns].
  LogSink(Recorder& recorder, const LogReplayOptions& options, std::int64_t compared_from, const LogMap& map,
          const Scenario& scenario, LogObservations& log, LogReplayReport& report)
      : RecordingSink(recorder, &report.remarks),
        options_(options),
        compared_from_(compared_from),
        map_(map),
        scenario_(scenario),
        log_(log),
        report_(report) {
    if (!options.memory) return;
    certainty_.emplace(*options.memory, map.begins_with_controller);
    knows_state_ = map.begins_with_controller;
    report.certain.emplace().memory = *options.memory;
  }

  Result<void> emit(const TickData& now) override {
    auto done = RecordingSink::emit(now);
    if (now.seen->joystick) note_joystick(now);
    if (done && now.alive && log_.commands()) compare(now);
    return done;
  }
  /// True if no tick whose state is known, from some one on up to the last, had a missing or late input.
  bool knows_state() const { return knows_state_; }
  /// The controller has the robot's state in the next tick.
  void know_state() { knows_state_ = is_told_ = true; }
  /// After the last tick.
  void finish();

 private:
  /// The comparison of one tick.
  struct Judged {
    std::int64_t tick = 0;
    bool is_irregular = false;       // its command may depend on a message that is late or missing
    bool misses_input = false;       // so may its inputs
    bool is_told = false;            // the state with which it begins is in the log
    bool moves = false;              // its commands aren't those of the tick before
    bool may_be_of_another = false;  // its command may be another tick's
    std::int64_t compared = 0;       // numbers
    std::vector<double> off = {};    // replayed minus logged, by column; only if certain ticks are counted
    std::vector<Divergence> differences = {};
  };
  void compare(const TickData& now);
  Judged compare_tick(const TickData& now);
  void take_judged();
  void note_joystick(const TickData& now);
  bool is_irregular(std::int64_t tick, bool has_command) const;
  bool misses_input(std::int64_t tick) const;
  bool lacks_command(bool has_command) const;
  void judge(Judged tick);
  void report(Judged tick);
  void end_doubt();
  void count_if_certain(const Judged& tick);
  /// From the first tick on [s].
  double log_time(std::int64_t tick) const;

  const LogReplayOptions& options_;
  const std::int64_t compared_from_;
  const LogMap& map_;
  const Scenario& scenario_;
  LogObservations& log_;
  LogReplayReport& report_;
  /// A late message may also be taken for one of a later tick.
  static constexpr int ticks_of_doubt = 5;
  /// After this number of successive ticks that differ, the differences count: missing or late messages don't explain
  /// them.
  static constexpr std::size_t longest_doubt = 100;
  CommandTiming timing_;
  std::optional<LogCertainty> certainty_;
  RestOfLog rest_;
  bool knows_state_ = false, is_told_ = false;  // before the next tick
  std::vector<double> last_commands_;
  bool lacked_command_ = false;         // the tick before, for which a message is missing or late
  std::unique_ptr<RowJudge> judge_;     // none before the first tick
  std::deque<Judged> waiting_;          // ticks whose differences aren't all known
  std::deque<Divergence> differences_;  // of the waiting ticks
  JoystickReading joystick_;            // at the last tick
  bool agreed_ = true;                  // in the last tick that was compared
  int doubt_ = 0;                       // number of ticks in a row that have to agree until a difference counts
  std::vector<Judged> in_doubt_;        // the last ticks, if all of them differ and are in doubt
};

}  // namespace rehearse
