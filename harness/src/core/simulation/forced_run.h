// A scenario's world beside a robot, step by step: each step begins in the state that the robot had, under the command
// that it got. What a step adds to a difference is the world's alone; nothing grows from tick to tick. Internal.
//
// A joint's difference after a step is that of its velocity. Over a span of ticks the differences are summed: the noise
// of the measured velocities cancels but for the first and the last one, and an acceleration that the world lacks grows
// with the span. The noise is estimated from the flight itself, as the third differences of its velocities.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct ForcedJoint {
  std::string name;
  bool is_linear = false;  // its unit is that of a length
  double noise = 0.0;      // of its measured velocity, standard deviation [rad/s] or [m/s]
  double missing = 0.0;    // the largest mean acceleration over a span that the world lacks [rad/s^2], [m/s^2]
  double floor = 0.0;      // what noise alone may give of it
  std::int64_t worst = 0;  // the tick in which that span ends
  std::optional<std::int64_t> from = {};  // the first tick from which on the world differs
};

struct ForcedReport {
  std::string undecided;  // why the state isn't complete: "..."; empty: it is
  std::int64_t steps = 0;
  double span = 0.0;  // [s]
  std::vector<ForcedJoint> joints;

  /// The joint that differs first; null: none does.
  const ForcedJoint* first() const;
};

/// Compares the world of a scenario with a flight. Fails if the scenario doesn't fit the flight: its body, controller,
/// time step, or joints. `progress`: called with ticks, now and then; null: never.
Result<ForcedReport> compare_with_flight(const Scenario& scenario, const Trace& flight,
                                         const std::function<void(std::int64_t done, std::int64_t all)>& progress = {});

}  // namespace rehearse
