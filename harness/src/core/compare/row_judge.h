// RowJudge: compares rows of numbers while they come, tick by tick, by the rules of a comparison of recordings. Replays
// use it. Rows before and after a tick are kept as long as the rules allow for time. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "number_judge.h"
#include "series_scale.h"

namespace rehearse {

class RowJudge {
 public:
  /// Called with each difference, in the order of ticks.
  using OnDifference = std::function<void(Divergence&&)>;

  /// `rules`: null: no difference is allowed. They must outlive this. `scales`: of the golden's series.
  RowJudge(const std::vector<ToleranceRule>* rules, SeriesScales scales, double time_step, OnDifference differs);
  ~RowJudge();

  /// Adds a channel, whose topic and metadata are used, and returns its number.
  std::size_t add_channel(const TraceChannel& description);
  /// Sets the columns of the next rows. If they change, values of earlier rows are not taken for early or late ones.
  void set_columns(std::size_t channel, const std::vector<TraceColumn>& columns);
  /// True if all rows of a channel are needed. Else only rows that differ are.
  bool needs_equal_rows(std::size_t channel) const;
  /// Adds the next rows of a channel.
  void add(std::size_t channel, std::int64_t tick, std::span<const std::uint64_t> golden,
           std::span<const std::uint64_t> actual);
  /// Adds a row of the golden that is only compared with rows of other ticks.
  void add_golden(std::size_t channel, std::int64_t tick, std::span<const std::uint64_t> golden);
  /// Adds a difference other than of two numbers.
  void add(Divergence&& found);
  /// All rows of the tick were added.
  void end_tick(std::int64_t tick);
  /// Judges the remaining rows.
  void finish();

  /// The ticks before this one are judged.
  std::int64_t judged_until() const { return judged_until_; }
  /// The largest time that a value may come early by rules for the channels so far [s].
  double lead() const { return lead_; }
  /// The tolerance of a column.
  double tolerance(std::size_t channel, std::size_t column) const;

 private:
  struct Channel;
  void judge(std::int64_t until);
  void pass_on(std::int64_t until);

  const std::vector<ToleranceRule>* rules_;
  const SeriesScales scales_;
  const double time_step_;  // [s]
  const OnDifference differs_;
  std::vector<std::unique_ptr<Channel>> channels_;
  std::vector<Divergence> found_;  // not passed on yet
  std::int64_t judged_until_ = 0;  // tick
  std::int64_t last_tick_ = -1;    // of end_tick()
  double lead_ = 0.0;              // [s]
  bool allows_for_time_ = false;   // a channel does
};

}  // namespace rehearse
