// LogTrack: the values of a topic that a later tick may still need.
//
// Times are nanoseconds of the log's clock. Samples are added in order of time, equal times allowed; ticks go forward.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace rehearse {

template <std::size_t N>
class LogTrack {
 public:
  struct Sample {
    std::int64_t time = 0;  // [ns]
    std::array<double, N> values{};
  };
  /// Between two samples, or at one of them.
  struct Span {
    const Sample* before = nullptr;  // at or before the tick; never null
    const Sample* after = nullptr;   // after the tick; null: hold
    double fraction = 0.0;           // of the way from before to after, 0 <= fraction < 1
  };

  void add(std::int64_t time, const std::array<double, N>& values) { samples_.push_back({time, values}); }

  /// The latest sample that was added; null: none.
  const Sample* newest() const { return samples_.empty() ? nullptr : &samples_.back(); }

  /// The time of the first sample after the last at() [ns]; nullopt: it isn't there yet.
  std::optional<std::int64_t> next() const {
    return samples_.size() > 1 ? std::optional(samples_[1].time) : std::nullopt;
  }

  /// Drops samples that no later tick needs. Nullopt: the first sample comes after the tick.
  std::optional<Span> at(std::int64_t time, bool interpolate) {
    while (samples_.size() > 1 && samples_[1].time <= time) samples_.pop_front();
    if (samples_.empty() || samples_.front().time > time) return std::nullopt;
    Span span{&samples_.front()};
    if (!interpolate || samples_.size() < 2 || samples_.front().time == time) return span;
    span.after = &samples_[1];
    span.fraction =
        static_cast<double>(time - span.before->time) / static_cast<double>(span.after->time - span.before->time);
    return span;
  }

 private:
  std::deque<Sample> samples_;
};

/// Interpolates between two values. At 0 the result has the bits of the first one.
inline double mix(double from, double to, double fraction) { return from + (to - from) * fraction; }

}  // namespace rehearse
