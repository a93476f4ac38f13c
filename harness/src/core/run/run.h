// Run: the loop of all runs. In each tick it observes, commands, emits and advances. A sink gets the observation before
// control() is called, so that a recording contains it however that call ends.
//
// A run is composed of a source of observations, a commander and a sink:
//
//   run               observations            commands               sink
//   recording         WorldSource             HostedCommands         RecordingSink
//   plant level       WorldSource             RecordedCommands       RecordingSink
//   replay            RecordingSource         HostedCommands         ReplayComparison
//   branch            RecordingSource, then   HostedCommands         ReplayComparison or CopyingSink, then
//                     WorldSource                                    RecordingSink
//   log               LogObservations         HostedCommands         LogSink
//   ControllerBench   set by the test         HostedCommands         read by the test
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/messages.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace rehearse {

class ControllerHost;
struct TrueReading;

/// The data of one tick in the loop. Pointers are valid until the source advances.
struct TickData {
  std::int64_t tick = 0;
  Command& command;         // the command of the run
  bool is_closing = false;  // the state after the last step: no commands, no further step

  // set by the source of observations
  const Observation* seen = nullptr;  // the observation to record
  /// The observation for the controllers: differs where joints have noise or are altered.
  const Observation* read = nullptr;
  const std::vector<TrueReading>* truths = nullptr;  // of sensors with errors; null: unknown
  std::uint64_t state_hash = 0;                      // hash of the world's state; 0: there is no world
  const std::vector<LinkPair>* touching = nullptr;   // link pairs in contact in the last step; null: unknown
  std::vector<std::byte> checkpoint{};               // the world's state, in ticks that have a checkpoint; else empty
  std::vector<msg::Event> events{};                  // events of the source

  // set by the commander
  ControllerHost* host = nullptr;  // host of the called controllers; null: none were called
  bool alive = true;               // false: a controller failed in this tick, which is the run's last
};

/// The source of a run's commands.
class Commander {
 public:
  virtual ~Commander() = default;
  /// True if a controller has failed: there is no further tick.
  virtual bool failed() const { return false; }
  /// Passes the observation to the controllers.
  virtual void prepare(TickData&) {}
  /// Determines the commands of this tick, and writes those that act in the tick's own step into the command.
  virtual void act(TickData& now) = 0;
  /// Writes the commands that act one tick late into the command. Must be called after the step.
  virtual void act_late(TickData& now) = 0;
};

/// The source of a run's observations.
class ObservationSource {
 public:
  virtual ~ObservationSource() = default;
  /// Gets the observation at the beginning of the tick. False: there is no such tick, and the run ends.
  virtual Result<bool> observe(TickData& now) = 0;
  /// Makes one step under the command, then calls act_late() of `commands`. False: there is no state from which to
  /// continue.
  virtual Result<bool> advance(TickData& now, Commander& commands) = 0;
};

/// The destination of a run's ticks: a file, or a comparison with a different run.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Takes the observation of a tick and the inputs of its controllers, before its commands exist.
  virtual Result<void> begin_tick(const TickData&) { return {}; }
  /// Takes the whole tick.
  virtual Result<void> emit(const TickData& now) = 0;
};

class Run {
 public:
  using Progress = std::function<void(std::int64_t done, std::int64_t all)>;
  static constexpr std::int64_t no_end = std::numeric_limits<std::int64_t>::max();

  /// Ticks `begin` to `end` - 1; with no_end, as many as the source has. `time_step` [s]. The parts must outlive this.
  Run(double time_step, ObservationSource& source, Commander& commands, Sink& sink, std::int64_t begin,
      std::int64_t end)
      : time_step_(time_step),
        source_(&source),
        commands_(&commands),
        sink_(&sink),
        begin_(begin),
        end_(end),
        tick_(begin) {}

  /// From now on, up to the new end, observations come from `source`, and ticks go to `sink`.
  void change(ObservationSource& source, Sink& sink, std::int64_t end);
  /// The tick of the last step() is the last.
  void end() { end_ = tick_; }
  /// `report` is called about every hundredth of `all` ticks with the number of ticks made since this call; null:
  /// never.
  void report_progress(Progress report, std::int64_t all);

  /// Makes one tick. False: the run was already over, or ends in this tick. Fails if the source or the sink fails.
  Result<bool> step();
  /// Makes all ticks up to the end.
  Result<void> go();
  /// Emits the state after the last tick.
  Result<void> close();

  std::int64_t tick() const { return tick_; }  // the next tick
  /// A signal ended the run before tick().
  const std::optional<Diagnostic>& interruption() const { return interruption_; }
  /// The source could not continue after tick() - 1.
  bool broke_down() const { return broke_down_; }

  Command command;  // the command that moves the world

 private:
  const double time_step_;  // [s]
  ObservationSource* source_;
  Commander* commands_;
  Sink* sink_;
  std::int64_t begin_;  // first tick of the reported progress
  std::int64_t end_;
  std::int64_t tick_;
  bool broke_down_ = false;
  std::optional<Diagnostic> interruption_;
  Progress progress_;
  std::int64_t all_ = 0;
};

}  // namespace rehearse
