// LogMemory: how long a controller's commands depend on the state that it had before a tick. A log that begins in
// mid-run, or lacks a message, doesn't contain this state. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "command_ranges.h"
#include "command_timing.h"
#include "log_replay.h"

namespace rehearse {

/// The commands of a replay by the log's time [us].
class CommandRecord {
 public:
  /// Of the first tick, `time`: [ns].
  void begin(std::int64_t time, const std::vector<CommandColumn>& columns = {});
  /// `time`: [ns].
  void add(std::int64_t time, const std::vector<CommandPair>& pairs);
  /// An input of the tick at that time [ns] is missing in the log, or late. Before add() of the tick.
  void interrupt(std::int64_t time) { interruptions_.push_back((time + 500) / 1000); }
  /// True if there are commands in the first twenty ticks, without a gap of over five ticks. Else inputs may be missing
  /// there, and a controller without new inputs shows no memory. `time_step`: [s].
  bool begins_steadily(double time_step) const;
  std::int64_t first_time() const { return first_time_; }  // [us]
  const std::map<std::int64_t, std::vector<double>>& all() const { return commands_; }
  /// Replayed minus logged, of the ticks for which the log has all numbers.
  const std::map<std::int64_t, std::vector<double>>& off() const { return off_; }
  /// The ticks that are interrupted.
  const std::vector<std::int64_t>& interruptions() const { return interruptions_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& ranges() const { return ranges_; }
  /// For answers between processes.
  void each_part(auto& each) { each_part_of(*this, each); }
  void each_part(auto& each) const { each_part_of(*this, each); }

 private:
  static void each_part_of(auto& record, auto& each) {
    each(record.first_time_), each(record.commands_), each(record.off_), each(record.interruptions_);
    each(record.names_), each(record.ranges_);
  }

  std::int64_t first_time_ = 0;  // of the first tick [us]
  std::map<std::int64_t, std::vector<double>> commands_, off_;
  std::vector<std::int64_t> interruptions_;
  std::vector<std::string> names_;  // of the numbers, as PAN/u
  std::vector<double> ranges_;      // of the log's commands
};

/// True if the differences from the log's commands are none of a state that the log doesn't contain.
///
/// A state that two controllers don't share fades, stays, or wanders as the controller lets it: `from_the_start` and
/// `started_later` show it, because they have the same inputs. In the second half of the longest stretch without an
/// interruption, growth(x) is the most by which |x| exceeds its earlier minimum. With d the difference of a number from
/// the log's, and e that of the two controllers, as many ticks after the start of the later one, a missing state
/// explains d if growth(d) <= 10 growth(e) max|d| / max|e|. It is told apart if the growth is larger, and at least 0.2
/// of the range of the log's commands in that time, and 0.05 of their whole range: by a changed sign, exchanged joints,
/// or a gain off by half.
bool is_no_state(const CommandRecord& from_the_start, const CommandRecord& started_later);

/// The number of ticks after which two controllers command alike that were fed with the same inputs, but one of them
/// from a later tick on. 0: they always do. None: they differ in the second half of the compared ticks, too, or fewer
/// than 20 ticks were compared. `time_step`: [s].
std::optional<std::int64_t> memory_of(const CommandRecord& from_the_start, const CommandRecord& started_later,
                                      double time_step);

/// Decides which ticks of a log are certain: their commands follow from inputs that the log contains.
class LogCertainty {
 public:
  /// `memory`: see memory_of(). `knows_beginning`: the controller starts at tick 0.
  LogCertainty(std::optional<std::int64_t> memory, bool knows_beginning);

  /// The next compared tick. `interrupted`: an input of it is missing in the log, or late; `agrees`: its commands are
  /// within tolerance; `moves`: they aren't those of the tick before. True: the tick is certain.
  bool take(std::int64_t tick, bool interrupted, bool agrees, bool moves);
  /// The state with which the tick begins is known.
  void know(std::int64_t tick) { known_from_ = std::min(known_from_, tick); }

 private:
  /// So many ticks that agree in a row, and so many moves among them, are no accident: the state is the robot's.
  static constexpr int enough_ticks = 100, enough_moves = 10;

  const std::optional<std::int64_t> memory_;
  std::int64_t known_from_;  // tick
  int agreed_ = 0, moved_ = 0;
};

/// Collects the differences of the ticks that aren't certain.
class RestOfLog {
 public:
  /// `at`: the log's time [s]; `off`: replayed minus logged, by column.
  void add(double at, const std::vector<double>& off);
  /// Nullopt: there are no such ticks.
  std::optional<LogRest> report(const std::vector<CommandColumn>& columns) const;

 private:
  double from_ = 0.0;
  std::int64_t ticks_ = 0;
  std::vector<double> low_, high_;  // by column
};

}  // namespace rehearse
