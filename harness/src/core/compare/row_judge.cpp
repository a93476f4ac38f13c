#include "row_judge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "base/clock.h"
#include "compared_traces.h"
#include "core/kinds/channel_name.h"
#include "core/trace/trace_windows.h"
#include "divergence_text.h"

namespace rehearse {

struct RowJudge::Channel final : NumberFindings {
  Channel(RowJudge& rows, const TraceChannel& description) : owner(rows), golden(description), actual(description) {}

  /// The columns of both tables are known.
  void begin() {
    NumberRules rules;
    rules.tolerances = owner.rules_;
    rules.scale_of = [this](std::size_t column) {
      const auto scale = owner.scales_.find({golden.topic, golden.columns[column].element});
      return scale == owner.scales_.end() ? 0.0 : scale->second;
    };
    judge.emplace(rules, golden, actual, *this);
    std::tie(lead, lag) = judge->lead_and_lag();
  }
  bool allows_for_time() const { return lead > 0.0 || lag > 0.0; }

  /// Judges the pairs before a tick, and drops the rows that no later row needs.
  void judge_before(std::int64_t until) {
    const auto end = std::ranges::find_if(pairs, [&](const auto& pair) { return ticks[pair.first] >= until; });
    if (end != pairs.begin()) {
      const std::vector<std::pair<std::size_t, std::size_t>> complete(pairs.begin(), end);
      judge->take({golden, actual, complete});
      pairs.erase(pairs.begin(), end);
    }
    const auto reach = static_cast<std::int64_t>(std::ceil(lag / owner.time_step_)) + 1;
    drop_before(until - reach);
  }

  void drop_before(std::int64_t tick) {
    const auto rows = static_cast<std::size_t>(std::ranges::lower_bound(ticks, tick) - ticks.begin());
    const std::size_t of_actual = pairs.empty() ? actual.times.size() : pairs.front().second;
    drop_messages(golden, rows);
    drop_messages(actual, of_actual);
    ticks.erase(ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(rows));
    for (auto& [of_golden, other] : pairs) {
      of_golden -= rows;
      other -= of_actual;
    }
  }

  Divergence place_of(const TraceChannel& table, std::size_t row) const override {
    Divergence place;
    place.tick = ticks[row];
    place.time = time_of(place.tick, owner.time_step_);
    place.channel = table.topic;
    return place;
  }
  bool count(const DifferingNumber&) override { return true; }
  void describe(Divergence divergence, bool /*beyond*/) override { owner.add(std::move(divergence)); }

  RowJudge& owner;
  TraceChannel golden, actual;                             // the kept rows; of the actual ones only those of pairs
  std::vector<std::int64_t> ticks;                         // of the golden's rows
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  // not judged yet
  std::optional<NumberJudge> judge;                        // none: no columns are known
  double lead = 0.0, lag = 0.0;                            // the largest of its columns [s]
};

namespace {

void append(TraceChannel& table, std::uint64_t time, std::span<const std::uint64_t> row) {
  table.times.push_back(time);
  table.cells.insert(table.cells.end(), row.begin(), row.end());
}

constexpr std::int64_t no_end = std::numeric_limits<std::int64_t>::max();

}  // namespace

RowJudge::RowJudge(const std::vector<ToleranceRule>* rules, SeriesScales scales, double time_step, OnDifference differs)
    : rules_(rules), scales_(std::move(scales)), time_step_(time_step), differs_(std::move(differs)) {}

RowJudge::~RowJudge() = default;

std::size_t RowJudge::add_channel(const TraceChannel& description) {
  channels_.push_back(std::make_unique<Channel>(*this, description));
  return channels_.size() - 1;
}

void RowJudge::set_columns(std::size_t channel, const std::vector<TraceColumn>& columns) {
  Channel& changed = *channels_[channel];
  if (changed.judge) changed.judge_before(no_end);
  changed.golden.columns = columns;
  for (TraceColumn& column : changed.golden.columns) column.series = series_name(changed.golden.topic, column.element);
  changed.actual.columns = changed.golden.columns;
  changed.begin();
  lead_ = std::max(lead_, changed.lead);
  allows_for_time_ = allows_for_time_ || changed.allows_for_time();
}

bool RowJudge::needs_equal_rows(std::size_t channel) const { return channels_[channel]->allows_for_time(); }

double RowJudge::tolerance(std::size_t channel, std::size_t column) const {
  return channels_[channel]->judge->tolerance(column);
}

void RowJudge::add(std::size_t channel, std::int64_t tick, std::span<const std::uint64_t> golden,
                   std::span<const std::uint64_t> actual) {
  Channel& of = *channels_[channel];
  add_golden(channel, tick, golden);
  if (std::ranges::equal(golden, actual)) return;
  append(of.actual, of.golden.times.back(), actual);
  of.pairs.emplace_back(of.golden.times.size() - 1, of.actual.times.size() - 1);
  if (!of.allows_for_time()) of.judge_before(no_end);
}

void RowJudge::add_golden(std::size_t channel, std::int64_t tick, std::span<const std::uint64_t> golden) {
  Channel& of = *channels_[channel];
  if (!of.allows_for_time() && of.pairs.empty()) of.drop_before(no_end);
  append(of.golden, nanoseconds_of(tick, time_step_), golden);
  of.ticks.push_back(tick);
}

void RowJudge::add(Divergence&& found) { found_.push_back(std::move(found)); }

/// Rows are judged in groups, because an envelope is made for all kept rows.
void RowJudge::end_tick(std::int64_t tick) {
  last_tick_ = tick;
  if (!allows_for_time_) return pass_on(tick + 1);
  constexpr std::int64_t group = 256;  // [ticks]
  const auto ahead = static_cast<std::int64_t>(std::ceil(lead_ / time_step_));
  if (tick - judged_until_ >= 2 * ahead + group) judge(tick - ahead);
}

void RowJudge::judge(std::int64_t until) {
  for (const auto& channel : channels_)
    if (channel->judge) channel->judge_before(until);
  pass_on(until);
}

/// Passes on the differences before a tick.
void RowJudge::pass_on(std::int64_t until) {
  judged_until_ = until;
  if (found_.empty()) return;
  std::ranges::stable_sort(found_, {}, &Divergence::tick);
  const auto end = std::ranges::lower_bound(found_, until, {}, &Divergence::tick);
  std::vector<Divergence> rest(std::make_move_iterator(end), std::make_move_iterator(found_.end()));
  found_.erase(end, found_.end());
  for (Divergence& found : std::exchange(found_, std::move(rest))) differs_(std::move(found));
}

void RowJudge::finish() { judge(no_end); }

}  // namespace rehearse
