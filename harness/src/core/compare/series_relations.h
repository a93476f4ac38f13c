// Relations between series of two runs: a series that differs has the recorded values of another one, or its own ones
// scaled, shifted or late. A relation is a fact about the values, from which the mistake can be read. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {

/// A series of numbers in the recording, and in the present run at the same ticks.
struct PairedSeries {
  std::string name;
  std::vector<std::int64_t> ticks;  // ascending
  std::vector<double> recorded;     // one for each tick
  std::vector<double> present;      // likewise
};

/// The relation of a present series to recorded ones, in all its values, up to a millionth of its range.
struct SeriesRelation {
  enum class Kind {
    order,   // it has the recorded values of `other`, plus `number`
    scale,   // it is `number` times the recorded one
    offset,  // it is the recorded one plus `number`
    delay,   // it is the recorded one of `steps` values before; negative: after
    stale    // it is `other` of `steps` values before; the recorded one is that of `recorded_steps` before
  };
  Kind kind;
  std::size_t series;     // index in the series that were given
  std::size_t other = 0;  // likewise
  double number = 0.0;
  int steps = 0, recorded_steps = 0;
};

/// Finds the relations: of each series at most one, in their order. A series with two has none. Series that change
/// fewer than ten times have none: too much would fit them. There is none at all if a series without relation differs
/// at an earlier tick than all others: the relations may be its consequences.
std::vector<SeriesRelation> find_relations(const std::vector<PairedSeries>& series);

/// One sentence, without a full stop; empty if no relation was found. `is_whole`: the series have all values of the
/// runs.
std::string to_string(const std::vector<SeriesRelation>& relations, const std::vector<PairedSeries>& series,
                      bool is_whole = true);

}  // namespace rehearse
