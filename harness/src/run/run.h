// Run: the loop that all runs are. In each tick it observes, commands, emits and advances.
//
// Two parts and a sink are chosen for it:
//
//   run               observations            commands               sink
//   recording         WorldSource             HostedCommands         RecordingSink
//   plant level       WorldSource             RecordedCommands       RecordingSink
//   replay            RecordingSource         HostedCommands         ReplayComparison
//   branch            RecordingSource, then   HostedCommands         CopyingSink, then
//                     WorldSource                                    RecordingSink
//   log               LogObservations         HostedCommands         LogSink
//   ControllerBench   what the test sets      HostedCommands         what the test reads
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

/// One tick on its way through the loop. Pointers are valid until the source advances.
struct Moment {
  std::int64_t tick = 0;
  Command& command;         // the run's
  bool is_closing = false;  // the state after the last step: nobody commands, nothing advances

  // by the source of observations
  const Observation* seen = nullptr;  // to be recorded
  const Observation* read = nullptr;  // by the controllers: differs where joints have noise or are altered
  std::uint64_t state_hash = 0;       // of the world; 0: there is no world
  const std::vector<LinkPair>* touching = nullptr;  // in the last step; null: not known
  std::vector<std::byte> checkpoint{};              // the world's state, in ticks that have a checkpoint; else empty
  std::vector<msg::Event> events{};                 // of the source itself

  // by the commander
  ControllerHost* host = nullptr;  // whose controllers were called; null: none were
  bool alive = true;               // false: a controller failed in this tick, which is the run's last
};

/// Where a run's commands come from.
class Commander {
 public:
  virtual ~Commander() = default;
  /// A controller has failed: there is no further tick.
  virtual bool failed() const { return false; }
  /// Finds out what is commanded in this tick, and writes what acts in its own step into the command.
  virtual void act(Moment& now) = 0;
  /// Writes what acts one tick late into the command. To be called after the step.
  virtual void act_late(Moment& now) = 0;
};

/// Where a run's observations come from.
class ObservationSource {
 public:
  virtual ~ObservationSource() = default;
  /// What is to be seen at the beginning of the tick. False: there is no such tick, and the run ends.
  virtual Result<bool> observe(Moment& now) = 0;
  /// One step under the command; then `commands` act_late(). False: there is no state to go on from.
  virtual Result<bool> advance(Moment& now, Commander& commands) = 0;
};

/// Where a run's ticks go: into a file, or beside those of another run.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual Result<void> emit(const Moment& now) = 0;
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

  /// From now on, up to another end, what is observed comes from there and goes there.
  void change(ObservationSource& source, Sink& sink, std::int64_t end);
  /// `report` is called about every hundredth of `all` ticks with those done since now; null: it isn't.
  void report_progress(Progress report, std::int64_t all);

  /// One tick. False: the run was over already, or ends in this tick. Fails if the source or the sink does.
  Result<bool> step();
  /// All ticks up to the end.
  Result<void> go();
  /// Emits the state after the last tick.
  Result<void> close();

  std::int64_t tick() const { return tick_; }  // the next one
  /// A signal ended the run before tick().
  const std::optional<Diagnostic>& interruption() const { return interruption_; }
  /// The source could not go on after tick() - 1.
  bool broke_down() const { return broke_down_; }

  Command command;  // what moves the world

 private:
  const double time_step_;  // [s]
  ObservationSource* source_;
  Commander* commands_;
  Sink* sink_;
  std::int64_t begin_;  // of what is reported as progress
  std::int64_t end_;
  std::int64_t tick_;
  bool broke_down_ = false;
  std::optional<Diagnostic> interruption_;
  Progress progress_;
  std::int64_t all_ = 0;
};

}  // namespace rehearse
