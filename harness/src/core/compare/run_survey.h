// RunSurvey: data of a whole run that a comparison needs before it judges a part of the run. One pass over the run
// collects it. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "event_sequences.h"
#include "tick_clock.h"

namespace rehearse {

/// A summary of all messages of a channel.
struct ChannelSurvey {
  std::uint64_t messages = 0;
  std::uint64_t first_time = std::numeric_limits<std::uint64_t>::max();  // [ns]
  std::uint64_t last_time = 0;                                           // [ns]
  std::uint64_t times_hash = 0;
  std::uint64_t hash = 0;             // of times and bytes
  bool in_order = true;               // by time
  std::uint64_t undecoded = 0;        // messages that can't be decoded
  std::uint64_t first_undecoded = 0;  // time of the first of them [ns]
  std::string problem = {};           // of the first

  /// A second with messages, and the number and the hash of all messages before it.
  struct Second {
    std::uint64_t begin = 0;  // [ns]
    std::uint64_t messages = 0;
    std::uint64_t hash = 0;
    bool operator==(const Second&) const = default;
  };
  std::vector<Second> seconds;

  void take(const TraceChannel& piece);
  /// The number of messages before the beginning of a second [ns].
  std::uint64_t messages_before(std::uint64_t second) const;
  bool operator==(const ChannelSurvey&) const = default;
};

/// The beginning of the second that a time belongs to [ns].
constexpr std::uint64_t second_of(std::uint64_t time) {
  constexpr std::uint64_t second = 1'000'000'000;  // [ns]
  return time / second * second;
}

/// Two surveys of a channel agree on all messages before this time, which begins a second [ns].
std::uint64_t equal_until(const ChannelSurvey& a, const ChannelSurvey& b);

struct RunSurvey {
  /// A survey without messages; take() adds them. `rules` must outlive this.
  RunSurvey(const std::vector<ToleranceRule>& rules, std::vector<WatchedLimit> limits)
      : edges(std::move(limits)), rules_(&rules) {}

  void take(const Trace& piece);
  /// `whole` has all channels and columns, events and changes of contact, and must outlive this.
  void finish(const Trace& whole);

  const Trace& whole() const { return *whole_; }
  /// The index of one of whole().channels().
  std::size_t index_of(const TraceChannel& channel) const;
  const ChannelSurvey& of(const TraceChannel& channel) const;
  /// The scale of a column, if it is judged by a relative tolerance; else 0.
  double scale_of(const TraceChannel& channel, std::size_t column) const;
  /// False for a value of a joint that a controller didn't read: it is NaN in all messages.
  bool is_read(const TraceChannel& channel, std::size_t column) const;

  TickClock clock;
  EdgeFinder edges;
  std::size_t size = 0;  // of all numbers, approximate [bytes]

 private:
  struct Column {
    bool needs_scale = false;
    double largest = 0.0;
    bool is_read = true;
  };
  void take_columns(const TraceChannel& channel, std::vector<Column>& columns) const;

  const std::vector<ToleranceRule>* rules_;
  const Trace* whole_ = nullptr;
  std::vector<ChannelSurvey> channels_;       // by index in whole().channels()
  std::vector<std::vector<Column>> columns_;  // by channel, then column
};

}  // namespace rehearse
