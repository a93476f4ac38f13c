// FlownMotion: the motion in a recording, as the numbers of a fit: its series with their noise, the commands of each
// tick, and the stretches that are compared. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

class Trace;

/// A recorded number of the robot, tick by tick.
struct FlownSeries {
  enum class Quantity { displacement, velocity, linear_velocity, angular_velocity };

  std::string name;  // "Arm/ELBOW/q"
  Quantity quantity = Quantity::displacement;
  int index = 0;       // id of the joint, or axis of the root link's velocity
  double noise = 0.0;  // standard deviation
};

/// Ticks of a recording in which a world moves from a state.
struct FlownStretch {
  std::int64_t begin = 0;        // the tick of the state
  std::int64_t first = 0;        // the compared ticks: from this one
  std::int64_t last = 0;         // to this one
  std::vector<std::byte> state;  // World::save() of a world of the nominal scenario; empty: it is estimated
};

class FlownMotion {
 public:
  struct Extent {
    std::int64_t compared = 2;  // ticks of a stretch
    std::int64_t lead = 0;      // ticks before them, in which the state of the drives comes about
    bool keeps_memory = true;   // no fitted number changes how long drives remember commands
  };
  /// Fails if the recording doesn't fit the scenario, or its states can't be estimated.
  static Result<std::unique_ptr<const FlownMotion>> read(const Scenario& scenario, const std::string& file,
                                                         const Extent& extent);

  const std::string& file() const { return file_; }
  std::size_t body() const { return body_; }
  const std::vector<FlownSeries>& series() const { return series_; }
  const std::vector<FlownStretch>& stretches() const { return stretches_; }
  bool has_complete_states() const { return has_complete_states_; }
  /// NaN: the recording doesn't have it.
  double measured(std::int64_t tick, std::size_t series) const {
    return numbers_[static_cast<std::size_t>(tick) * series_.size() + series];
  }
  /// The command that acts in the step from that tick.
  const Command& command(std::int64_t tick) const { return commands_[static_cast<std::size_t>(tick)]; }
  /// The commands to devices that act after that step.
  const Command& device_command(std::int64_t tick) const { return device_commands_[static_cast<std::size_t>(tick)]; }

 private:
  std::string file_;
  std::size_t body_ = 0;
  std::vector<FlownSeries> series_;
  std::vector<double> numbers_;  // by tick, then by series
  std::vector<Command> commands_, device_commands_;
  std::vector<FlownStretch> stretches_;
  bool has_complete_states_ = false;

  std::int64_t ticks() const { return static_cast<std::int64_t>(commands_.size()); }
  void read_numbers(const Scenario& scenario, const Trace& trace);
  Result<void> read_commands(const Scenario& scenario, const Trace& trace);
  void measure_noise();
  bool is_whole(std::int64_t first, std::int64_t last) const;
  Result<void> find_complete_stretches(const Scenario& scenario, const Trace& trace, const Extent& extent);
  Result<void> find_estimated_stretches(const Scenario& scenario, const Extent& extent);
};

/// The value of a series in an observation.
double value_of(const FlownSeries& series, const BodyObservation& body);

/// The longest time for which the drives of a scenario remember commands [s].
double memory_of_drives(const Scenario& scenario);

}  // namespace rehearse
