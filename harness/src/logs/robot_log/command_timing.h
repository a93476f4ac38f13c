// CommandTiming: whether the commands of a log agree with those of the present controller at other ticks than stated.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "log_replay.h"

namespace rehearse {

/// A number that the controller commands in a tick, and the one in the log.
struct CommandPair {
  std::optional<double> logged;
  double actual = 0.0;
  double tolerance = 0.0;
  double whole = 0.0;  // `actual` without the limits of the map
};

class CommandTiming {
 public:
  /// The next tick, with the numbers of all ticks in the same order; empty: it isn't compared.
  void add(std::vector<CommandPair> tick);
  /// The shift that leaves the fewest differing ticks, or neighbouring ticks. None if it doesn't explain nine of ten
  /// ticks that differ.
  std::optional<LogTiming> explanation() const;

 private:
  static constexpr int reach = 5;  // [ticks]
  struct Count {
    std::int64_t ticks = 0;
    std::int64_t different = 0;
  };
  struct Tick {
    std::vector<CommandPair> pairs;
    bool differs = false;
    bool agrees_with_neighbour = false;
  };
  void count(int shift, bool agrees);

  std::array<Count, 2 * reach + 1> counts_{};  // by shift + reach
  Count neighbours_;                           // ticks that differ; `different`: from both neighbours, too
  std::deque<Tick> last_;                      // the newest first
};

}  // namespace rehearse
