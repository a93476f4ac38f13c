// Aligns the times of a log with the times of another log, so that both can be compared.
#pragma once

#include <rehearse/diagnostic.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>

namespace rehearse {

struct Alignment {
  std::int64_t offset = 0;      // added to the times of the second log [ns]; with a drift, at `start`
  double drift = 0.0;           // added to the offset for each nanosecond after `start` [ns]; 0: none was found
  std::size_t drift_pairs = 0;  // number of pairs of messages that the drift was estimated from
  bool by_content = false;      // these are messages of equal content; else the nearest in order
  std::int64_t start = std::numeric_limits<std::int64_t>::max();  // the first message of the second log [ns]
  std::optional<double> correlation;                              // correlation of the series at this offset
  std::uint64_t matched = 0;      // number of messages with a counterpart of the same topic in the other log
  std::uint64_t lone_first = 0;   // number of messages without a counterpart in the first log, of topics of both logs
  std::uint64_t lone_second = 0;  // number of messages without a counterpart in the second log
  std::uint64_t left_out = 0;     // number of messages of the second log that would be before time 0
  double median_distance = 0.0;   // median distance of matched messages after the offset [s]
  double largest_distance = 0.0;  // [s]

  /// A time of the second log as a clock without drift would state it [ns].
  std::int64_t without_drift(std::int64_t time) const {
    return drift == 0.0 ? time : time + std::llround(drift * static_cast<double>(time - start));
  }
  /// A time of the second log by the clock of the first log [ns].
  std::int64_t time_of(std::int64_t time) const { return without_drift(time) + offset; }
};

/// Writes `second` as `target`, with times that fit `first`. The offset is estimated by the first message of a common
/// topic (`by` is "start"), or as the offset with the largest correlation of a series of both logs, refined to a
/// thousandth of the distance of messages. If one clock is faster, the drift is estimated as well, from messages of
/// equal content; if there are few, from the nearest messages. Then messages are matched by topic and order: each gets
/// the time of the nearest message of `first` within half of the usual distance; a time in its fields, named stamp, is
/// moved as well. Other messages are only moved by offset and drift. Fails if there is no common topic, if a log lacks
/// the series, or if the series isn't similar in both.
Result<Alignment> write_aligned(const std::filesystem::path& first, const std::filesystem::path& second,
                                const std::string& by, const std::filesystem::path& target);

}  // namespace rehearse
