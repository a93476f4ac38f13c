#include "call_clock.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace rehearse {
namespace {

std::chrono::nanoseconds now() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace

void CallClock::begin() { begin_ = now(); }
void CallClock::end(std::int64_t tick) { add(tick, now() - begin_); }

std::size_t CallClock::bin_of(std::uint64_t nanoseconds) {
  const int octave = std::bit_width(nanoseconds >> bits);
  return octave == 0
             ? nanoseconds
             : (static_cast<std::size_t>(octave) << bits) + (nanoseconds >> (octave - 1)) - (std::size_t{1} << bits);
}

double CallClock::upper_end(std::size_t bin) {
  const auto octave = static_cast<int>(bin >> bits);
  if (octave == 0) return static_cast<double>(bin) * 1e-9;
  const auto first = static_cast<double>((bin & ((std::size_t{1} << bits) - 1)) + (std::size_t{1} << bits));
  return std::ldexp(first + 1.0, octave - 1) * 1e-9;
}

void CallClock::add(std::int64_t tick, std::chrono::nanoseconds time) {
  const auto nanoseconds = static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0));
  ++calls_in_[bin_of(nanoseconds)];
  if (calls_++ > 0 && nanoseconds <= longest_) return;
  longest_ = nanoseconds;
  longest_tick_ = tick;
}

/// The smallest upper end of a bin that at least that share of the calls doesn't exceed.
double CallClock::quantile(double share) const {
  const auto wanted = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(calls_)));
  std::int64_t seen = 0;
  for (std::size_t bin = 0; bin < bins; ++bin)
    if ((seen += calls_in_[bin]) >= wanted) return std::min(upper_end(bin), static_cast<double>(longest_) * 1e-9);
  return static_cast<double>(longest_) * 1e-9;
}

ControlTimes CallClock::times(std::string controller, double period) const {
  ControlTimes times{std::move(controller), period, calls_};
  if (calls_ == 0) return times;
  times.median = quantile(0.5);
  times.p999 = quantile(0.999);
  times.longest = static_cast<double>(longest_) * 1e-9;
  times.longest_tick = longest_tick_;
  for (std::size_t bin = 0; bin < bins; ++bin)
    if (calls_in_[bin] > 0) times.histogram.emplace_back(upper_end(bin), calls_in_[bin]);
  return times;
}

}  // namespace rehearse
