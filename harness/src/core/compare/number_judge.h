// NumberJudge: compares the numbers of a channel of two runs, row by row. Comparisons of recordings, replays and
// replays of logs use it. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare_envelope.h"

namespace rehearse {

/// A span of time in which the numbers of a body are not judged; both ends are part of it [ns].
struct BlankedSpan {
  std::uint64_t from = 0;
  std::uint64_t until = 0;
};

/// The rules for the numbers of a channel. All that it refers to must outlive the judge.
struct NumberRules {
  /// Null: each number is compared by itself, and no difference is allowed.
  const std::vector<ToleranceRule>* tolerances = nullptr;
  std::function<double(std::size_t column)> scale_of = {};  // of a column of the golden; null: all are 0
  const std::map<std::string, double, std::less<>>* noise_floors = nullptr;               // null: none
  const std::map<std::string, std::vector<BlankedSpan>, std::less<>>* blanked = nullptr;  // null: none
  std::function<bool(std::string_view element)> takes = {};  // the elements to compare; null: all
  /// The seconds and nanoseconds of a time are one value in seconds; else two integers.
  bool joins_times = false;
  bool another_step = false;  // the time steps differ: numbers of ticks are left out

  bool is_exact() const { return tolerances == nullptr; }
};

/// A number or an orientation of a row whose bits differ.
struct DifferingNumber {
  const TraceChannel& golden;
  std::size_t row = 0;                   // of the golden
  std::span<const std::size_t> columns;  // one, or the four of an orientation
  double difference = 0.0;               // the judged one
  double tolerance = 0.0;
  bool in_noise = false;
  bool blanked = false;  // it isn't judged
  bool beyond = false;   // the difference is beyond its tolerance
};

/// Takes the differences that a judge finds.
class NumberFindings {
 public:
  virtual ~NumberFindings() = default;
  /// A divergence with tick, time and channel of a row.
  virtual Divergence place_of(const TraceChannel& golden, std::size_t row) const = 0;
  /// Counts a difference. True: it has to be described.
  virtual bool count(const DifferingNumber& number) = 0;
  virtual void describe(Divergence divergence, bool beyond) = 0;
  /// True: a hash that differs has to be marked.
  virtual bool wants_hash() const { return false; }
  /// A difference that fails nothing: of a hash, or of a number that isn't judged.
  virtual void mark(Divergence /*divergence*/) {}
};

/// Rows of two tables, and those of them that belong together.
struct MatchedRows {
  const TraceChannel& golden;
  const TraceChannel& actual;
  const std::vector<std::pair<std::size_t, std::size_t>>& pairs;
};

class NumberJudge {
 public:
  /// A series of both tables, and its tolerances.
  struct Column {
    std::size_t golden = 0;
    std::size_t actual = 0;
    CellKind kind = CellKind::floating;
    std::string element;
    std::string unit;
    double tolerance = 0.0;
    double noise = -1.0;  // noise floor: a difference up to it is noise; negative: unknown
    double lead = 0.0;    // [s]
    double lag = 0.0;     // [s]
    bool hash = false;
    bool wraps = false;
    const std::vector<BlankedSpan>* blanked = nullptr;   // times without judgement; null: none
    std::shared_ptr<const Envelope> envelope = nullptr;  // made at its first use
    double largest = 0.0;                                // difference so far; NaN is kept

    bool allows_for_time() const { return lead > 0.0 || lag > 0.0; }
  };
  /// Four columns x, y, z, w that are one orientation.
  using Orientation = std::array<Column, 4>;
  /// The columns of seconds and nanoseconds that are one time.
  struct TimeColumns {
    Column seconds, nanoseconds;  // the first has the name, tolerance and largest difference of the time
  };
  /// Elements that aren't compared.
  struct LoneColumns {
    std::vector<std::string> missing, extra, of_another_kind;
  };

  /// `golden` and `actual` describe the tables of all rows.
  NumberJudge(const NumberRules& rules, const TraceChannel& golden, const TraceChannel& actual,
              NumberFindings& findings);

  void take(const MatchedRows& rows);
  const LoneColumns& lone() const { return lone_; }
  /// The number of values of a row that are compared.
  std::size_t values() const;
  /// The largest of all columns [s].
  std::pair<double, double> lead_and_lag() const;
  std::vector<SeriesComparison> series() const;
  /// The tolerance of a column of the golden.
  double tolerance(std::size_t golden_column) const;

 private:
  /// How far a number is from the golden's.
  struct Distance {
    double difference = 0.0;  // from the number of the same tick
    std::optional<double> distance_from_envelope =
        std::nullopt;  // from the numbers within lead and lag; none: these don't matter
    double judged() const { return distance_from_envelope.value_or(difference); }
  };

  void match_columns(const TraceChannel& golden, const TraceChannel& actual);
  void find_tolerance(const TraceChannel& golden, Column& column) const;
  void group_orientations();
  void group_times(const TraceChannel& golden);
  void compare_cell(Column& column, std::size_t golden_row, std::size_t actual_row);
  void compare_orientation(Orientation& orientation, std::size_t golden_row, std::size_t actual_row);
  void compare_time(TimeColumns& time, std::size_t golden_row, std::size_t actual_row);
  void compare_norms(const Orientation& orientation, std::size_t golden_row, const Quaternion& expected,
                     const Quaternion& actual);
  double distance_from_envelope(Column& column, std::size_t golden_row, double actual) const;
  double distance_from_envelope(const Orientation& orientation, std::size_t golden_row, const Quaternion& actual) const;
  bool count(const Column& column, std::size_t golden_row, std::span<const std::size_t> columns,
             const Distance& distance, bool& beyond);
  void describe(const Column& column, std::size_t golden_row, Divergence numbers, const Distance& distance,
                bool beyond);
  Divergence place(const Column& column, std::size_t golden_row, Divergence numbers = {}) const;

  const NumberRules rules_;
  NumberFindings& findings_;
  const MatchedRows* rows_ = nullptr;  // the judged rows
  std::vector<Column> columns_;        // except those of orientations and times
  std::vector<Orientation> orientations_;
  std::vector<TimeColumns> times_;
  LoneColumns lone_;
  bool same_columns_ = true;
};

}  // namespace rehearse
