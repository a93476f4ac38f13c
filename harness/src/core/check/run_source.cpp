#include "run_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/clock.h"
#include "base/glob.h"
#include "core/expression/joint_series.h"
#include "core/expression/name_search.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// `link`: BODY/LINK. `name`: of a body, of a link, or an ending of it.
bool is_link_named(const std::string& link, const std::string& name) {
  return ends_with_segments(link, name) || link.starts_with(name + "/");
}

}  // namespace

RunSource::RunSource(const Trace& names) : names_(&names) {
  for (const auto& [name, place] : names.series()) all_names_.push_back(name);
}

std::size_t RunSource::use(const std::string& name) {
  const auto known = std::ranges::find(series_, name, &Series::name);
  if (known != series_.end()) return static_cast<std::size_t>(known - series_.begin());
  const SeriesPlace place = *names_->find_series(name);
  const TraceChannel& channel = names_->channels()[place.channel];
  Series& series = series_.emplace_back();
  series.name = name;
  series.unit = unit_of(channel.metadata, channel.columns[place.column].element);
  series.latest = no_value;
  found_.push_back(name);
  values_.resize(series_.size() * kept, no_value);
  return series_.size() - 1;
}

Result<std::size_t> RunSource::find_series(std::string_view name) {
  const auto found = REHEARSE_TRY(find_name(name, all_names_, "series"));
  return use(all_names_[found]);
}

Result<std::size_t> RunSource::find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) {
  const auto found = REHEARSE_TRY(find_joint_name(joint, quantity, of_command, all_names_));
  return use(all_names_[found]);
}

/// The names of links were compared with the models when the scenario was read.
Result<std::vector<std::size_t>> RunSource::find_links(std::string_view name) {
  const auto known = std::ranges::find(links_, name);
  if (known != links_.end()) return std::vector{static_cast<std::size_t>(known - links_.begin())};
  links_.emplace_back(name);
  return std::vector{links_.size() - 1};
}

Result<JointLimit> RunSource::find_limit(std::string_view joint, std::string_view limit) {
  const auto found = limits_.find(fmt::format("{} {}", joint, limit));
  if (found == limits_.end()) return error(fmt::format("the scenario has no {} limit of a joint '{}'", limit, joint));
  return JointLimit{found->second.value, found->second.unit};
}

void RunSource::prepare(const Expression& expression) {
  for (const Expression::Moment& moment : expression.moments()) held_.push_back({moment.series, moment.time, {}});
}

void RunSource::take_samples(const Trace& piece) {
  for (Series& series : series_) {
    const auto place = piece.find_series(series.name);
    if (!place) continue;
    const TraceChannel& channel = piece.channels()[place->channel];
    series.waiting.erase(series.waiting.begin(), series.waiting.begin() + static_cast<std::ptrdiff_t>(series.next));
    series.next = 0;
    for (std::size_t row = 0; row < channel.rows(); ++row)
      series.waiting.push_back({channel.times[row], channel.number(row, place->column)});
  }
}

void RunSource::take_ticks(const Trace& piece) {
  const TraceChannel* channel = piece.find_channel(run_topics::tick);
  if (!channel) return;
  const auto column = std::ranges::find(channel->columns, "tick", &TraceColumn::element) - channel->columns.begin();
  const bool has_numbers = static_cast<std::size_t>(column) < channel->columns.size();
  for (std::size_t row = 0; row < channel->messages(); ++row) {
    const auto count = passed_ + static_cast<std::int64_t>(waiting_ticks_.size());
    const std::int64_t number = has_numbers && row < channel->rows()
                                    ? static_cast<std::int64_t>(channel->bits(row, static_cast<std::size_t>(column)))
                                    : count;
    const bool is_known = !waiting_ticks_.empty() && waiting_ticks_.back().time == channel->times[row];
    if (!is_known && (!last_time_ || channel->times[row] > *last_time_))
      waiting_ticks_.push_back({channel->times[row], number});
  }
}

void RunSource::take(const Trace& piece, const OnTick& on_tick) {
  take_samples(piece);
  take_ticks(piece);
  waiting_events_.insert(waiting_events_.end(), piece.events().begin(), piece.events().end());
  waiting_changes_.insert(waiting_changes_.end(), piece.contact_changes().begin(), piece.contact_changes().end());
  // the next piece may have more messages of the last tick
  while (waiting_ticks_.size() > 1) pass(waiting_ticks_.front(), on_tick);
}

std::optional<std::uint64_t> RunSource::finish(const OnTick& on_tick) {
  while (!waiting_ticks_.empty()) pass(waiting_ticks_.front(), on_tick);
  return last_time_;
}

void RunSource::pass_samples(Series& series, std::size_t index, std::uint64_t time) {
  for (; series.next < series.waiting.size() && series.waiting[series.next].time <= time; ++series.next) {
    const Sample& sample = series.waiting[series.next];
    series.latest = sample.value;
    if (!series.first_message) series.first_message = passed_;
    if (!series.first_number && !std::isnan(sample.value)) series.first_number = passed_;
    for (HeldValue& held : held_)
      if (held.series == index && seconds_of(static_cast<std::int64_t>(sample.time)) <= held.time + 1e-9)
        held.value = sample.value;
  }
  values_[index * kept + static_cast<std::size_t>(passed_) % kept] = series.latest;
}

void RunSource::pass_contacts(std::uint64_t time) {
  for (; !waiting_changes_.empty() && waiting_changes_.front().stamp.to_ns() <= time; waiting_changes_.pop_front()) {
    const msg::ContactChange& change = waiting_changes_.front();
    const std::pair<std::string, std::string> pair{change.link, change.other};
    if (change.begins)
      touching_.insert(pair);
    else
      touching_.erase(pair);
  }
}

void RunSource::pass(const WaitingTick& waiting, const OnTick& on_tick) {
  const WaitingTick tick = waiting;
  waiting_ticks_.pop_front();
  for (std::size_t i = 0; i < series_.size(); ++i) pass_samples(series_[i], i, tick.time);
  Tick& now = ticks_[static_cast<std::size_t>(passed_) % kept];
  now.number = tick.number;
  now.seconds = seconds_of(static_cast<std::int64_t>(tick.time));
  now.events.clear();
  for (; !waiting_events_.empty() && waiting_events_.front().stamp.to_ns() <= tick.time; waiting_events_.pop_front())
    now.events.push_back(std::move(waiting_events_.front()));
  if (!links_.empty()) {
    pass_contacts(tick.time);
    if (now.touching != touching_) now.touching = touching_;
  } else {
    waiting_changes_.clear();
  }
  last_time_ = tick.time;
  on_tick(passed_, tick.time);
  ++passed_;
}

bool RunSource::touching(const std::vector<std::size_t>& links, const std::vector<std::size_t>& others,
                         std::int64_t tick) {
  const std::string& link = links_[links.front()];
  return std::ranges::any_of(slot(tick).touching, [&](const std::pair<std::string, std::string>& pair) {
    if (others.empty()) return is_link_named(pair.first, link) || is_link_named(pair.second, link);
    const std::string& other = links_[others.front()];
    return (is_link_named(pair.first, link) && is_link_named(pair.second, other)) ||
           (is_link_named(pair.second, link) && is_link_named(pair.first, other));
  });
}

bool RunSource::said(std::string_view pattern, std::int64_t tick) {
  return std::ranges::any_of(slot(tick).events, [&](const msg::Event& event) { return matches(pattern, event.text); });
}

bool RunSource::happened(std::string_view pattern, std::int64_t tick) {
  return std::ranges::any_of(slot(tick).events, [&](const msg::Event& event) {
    return matches(pattern, fmt::format("{} {}: {}", event.severity, event.source, event.text));
  });
}

bool RunSource::begins_with_nan(std::size_t series) const {
  const Series& of = series_[series];
  return of.first_number && *of.first_message < *of.first_number;
}

ExpressionSource::Sampled RunSource::sampled(std::size_t series, std::int64_t tick, CommandSide) const {
  const Series& of = series_[series];
  if (of.first_number && *of.first_number <= tick) return Sampled::yes;
  return of.first_message && *of.first_message <= tick ? Sampled::blank : Sampled::no;
}

const RunSource::HeldValue* RunSource::held_at(std::size_t series, double time, std::int64_t tick) const {
  if (slot(tick).seconds + 1e-9 < time) return nullptr;
  const auto held =
      std::ranges::find_if(held_, [&](const HeldValue& known) { return known.series == series && known.time == time; });
  return held == held_.end() ? nullptr : &*held;
}

ExpressionSource::Sampled RunSource::sampled_at(std::size_t series, double time, std::int64_t tick) const {
  const HeldValue* held = held_at(series, time, tick);
  if (!held || !held->value) return Sampled::no;
  return std::isnan(*held->value) ? sampled(series, tick, CommandSide::recorded) : Sampled::yes;
}

double RunSource::value_at(std::size_t series, double time, std::int64_t tick) {
  const HeldValue* held = held_at(series, time, tick);
  return held ? held->value.value_or(no_value) : no_value;
}

}  // namespace rehearse
