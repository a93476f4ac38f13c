// Aligns the times of a log with the times of another log, so that both can be compared.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace rehearse {

struct Alignment {
  std::int64_t offset = 0;            // added to the times of the second log [ns]
  std::optional<double> correlation;  // correlation of the series at this offset
  std::uint64_t matched = 0;          // number of messages with a counterpart of the same topic in the other log
  std::uint64_t lone_first = 0;   // number of messages without a counterpart in the first log, of topics of both logs
  std::uint64_t lone_second = 0;  // number of messages without a counterpart in the second log
  std::uint64_t left_out = 0;     // number of messages of the second log that would be before time 0
  double median_distance = 0.0;   // median distance of matched messages after the offset [s]
  double largest_distance = 0.0;  // [s]
};

/// Writes `second` as `target`, with times that fit `first`. The offset is estimated by the first message of a common
/// topic (`by` is "start"), or as the offset with the largest correlation of a series of both logs, refined to a
/// thousandth of the distance of messages. Then messages are matched by topic and order: each gets the time of the
/// nearest message of `first` within half of the usual distance; a time in its fields, named stamp, is moved as well.
/// Other messages are only moved by the offset. Fails if there is no common topic, if a log lacks the series, or if the
/// series isn't similar in both.
Result<Alignment> write_aligned(const std::filesystem::path& first, const std::filesystem::path& second,
                                const std::string& by, const std::filesystem::path& target);

}  // namespace rehearse
