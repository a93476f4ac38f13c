// RecordedCommands: the commands of the controllers of a recording, tick by tick. They move a simulation without its
// controllers.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/host/timing.h"
#include "core/kinds/channel_name.h"
#include "core/run/run.h"
#include "core/trace/trace_windows.h"

namespace rehearse {

class RecordedCommands final : public Commander {
 public:
  /// Finds the controllers' outputs. If the trace is without messages, they are read from its file during the run.
  /// Fails if the trace has commands for something that the scenario lacks: a body, a controller, a joint, a device;
  /// all of these are reported together. Scenario and trace must outlive this.
  static Result<RecordedCommands> find(const Scenario& scenario, const Trace& trace);

  /// The command before the first tick: joints have the drives of the controllers, and stay at their initial
  /// displacement; devices get the settings of initialize().
  Command initial() const;
  /// Passes over the commands before some tick whose effect on the command at `tick` later ones replace: every number
  /// of joints and links in the last second before it. Returns the first tick whose commands have to be put; 0: all.
  std::int64_t pass_over(std::int64_t tick);
  /// Writes the commands of a tick by the controllers without (or with) delay into the command. The last controller
  /// overrides earlier ones, external wrenches are summed, numbers that aren't finite are left out, as are
  /// commands that the scenario's faults lose. Ticks must come in ascending order.
  void put(std::int64_t tick, Timing timing, Command& command);

  void act(TickData& now) override { put(now.tick, Timing::same_step, now.command); }
  void act_late(TickData& now) override { put(now.tick, Timing::next_step, now.command); }

 private:
  /// One number of a joint's command.
  struct JointCell {
    std::size_t column = 0;
    int joint = 0;  // id
    double JointCommand::*number = nullptr;
    Drive drive = drive_none;
  };
  enum class Kind { joints, wrench, place, twist, device };
  struct Source {
    Kind kind = Kind::joints;
    std::size_t channel = 0;  // of the trace
    int body = 0;
    const ScenarioController* controller = nullptr;
    int target = 0;  // link or device index
    bool delayed = true;
    std::optional<std::size_t> delays = {};  // channel of the trace: the ticks in which `delayed` doesn't hold
    bool is_acted = false;                   // for a branch: the commands that moved the world before acted_until_
    bool before_the_run = false;             // its first message was sent in initialize()
    std::vector<JointCell> cells;            // of joints
    std::size_t next = 0;                    // row, of all that the run has
  };

  RecordedCommands(const Scenario& scenario, const Trace& trace) : scenario_(scenario), trace_(trace) {}
  /// The kind of a channel of a link's commands; nullopt: it moves nothing.
  static std::optional<Kind> link_kind(ChannelKind kind);
  Result<void> add(const ChannelName& name, int body, const ScenarioController& controller, bool delay,
                   std::size_t channel);
  Result<void> add_joints(Source& source);
  std::vector<TraceColumn> columns_with_numbers(std::size_t channel) const;
  void begin();
  std::vector<std::size_t> channels_read() const;
  bool replaces_all(const Source& source, const TraceChannel& table) const;
  const TraceChannel& table(std::size_t channel) const;
  bool is_used(const Source& source, std::int64_t tick) const;
  bool is_delayed(const Source& source, std::uint64_t now) const;
  void set_drives(std::int64_t tick, Command& command) const;
  void put_row(const Source& source, std::size_t row, Command& command) const;

  const Scenario& scenario_;
  const Trace& trace_;
  std::unique_ptr<TraceWindows> windows_;  // null: the trace's messages are in memory
  std::uint64_t window_end_ = 0;           // [ns]
  std::vector<Source> sources_;            // in the order of the controllers
  std::int64_t acted_until_ = 0;           // tick
};

}  // namespace rehearse
