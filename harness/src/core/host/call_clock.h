// CallClock: the wall times of a controller's calls of control(), in memory that doesn't grow with their number.
#pragma once

#include <rehearse/run_options.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

namespace rehearse {

class CallClock {
 public:
  /// A call begins, and ends.
  void begin();
  void end(std::int64_t tick);
  void add(std::int64_t tick, std::chrono::nanoseconds time);
  /// `controller`: "SR1/Walk"; `period`: the time step [s].
  ControlTimes times(std::string controller, double period) const;

 private:
  // Times below 64 ns have a bin each; the others share 64 bins with each power of two, so that a bin is 1.6 % wide.
  static constexpr int bits = 6;
  static constexpr std::size_t bins = (64 - bits + 1) << bits;
  static std::size_t bin_of(std::uint64_t nanoseconds);
  static double upper_end(std::size_t bin);  // [s]
  double quantile(double share) const;       // [s]

  std::chrono::nanoseconds begin_{0};  // of the present call, on the clock of the machine
  std::array<std::int64_t, bins> calls_in_{};
  std::int64_t calls_ = 0;
  std::uint64_t longest_ = 0;  // [ns]
  std::int64_t longest_tick_ = 0;
};

}  // namespace rehearse
