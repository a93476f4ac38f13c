#include "run_survey.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "compare_parts.h"
#include "series_scale.h"
#include "trace/hashing.h"

namespace rehearse {

TickClock::TickClock(const Trace& trace) { take(trace); }

void TickClock::add(std::uint64_t time, std::int64_t tick) {
  if (times_.empty()) first_tick_ = tick;
  if (ticks_.empty() && tick != tick_of(times_.size())) list_ticks();
  times_.push_back(time);
  if (!ticks_.empty()) ticks_.push_back(tick);
}

std::int64_t TickClock::tick_of(std::size_t index) const {
  return ticks_.empty() ? first_tick_ + static_cast<std::int64_t>(index) : ticks_[index];
}

void TickClock::list_ticks() {
  ticks_.resize(times_.size());
  std::iota(ticks_.begin(), ticks_.end(), first_tick_);
}

void TickClock::take(const Trace& piece) {
  for (const TraceChannel& channel : piece.channels()) {
    if (channel.type != msg::Tick::type_name || channel.columns.empty()) continue;
    const std::size_t column = column_of(channel, "tick");
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      add(channel.times[row], column < channel.columns.size() ? static_cast<std::int64_t>(channel.bits(row, column))
                                                              : static_cast<std::int64_t>(channel.earlier + row));
    }
    break;
  }
}

void TickClock::put_in_order() {
  if (std::is_sorted(times_.begin(), times_.end())) return;
  std::vector<std::size_t> order(times_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return times_[a] < times_[b]; });
  if (ticks_.empty()) list_ticks();
  const TickClock before = *this;
  for (std::size_t i = 0; i < order.size(); ++i) {
    times_[i] = before.times_[order[i]];
    ticks_[i] = before.ticks_[order[i]];
  }
}

std::int64_t TickClock::tick_at(std::uint64_t time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return after == times_.begin() ? 0 : tick_of(static_cast<std::size_t>(after - times_.begin()) - 1);
}

bool TickClock::has(std::uint64_t time) const { return std::binary_search(times_.begin(), times_.end(), time); }

void RunSurvey::take(const Trace& piece) {
  clock.take(piece);
  edges.take(piece);
  channels_.resize(piece.channels().size());
  scales_.resize(piece.channels().size());
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const TraceChannel& channel = piece.channels()[i];
    ChannelSurvey& survey = channels_[i];
    size += channel.messages() * (2 + channel.columns.size()) * sizeof(std::uint64_t);
    survey.messages += channel.messages();
    for (std::size_t message = 0; message < channel.messages(); ++message) {
      const std::uint64_t time = channel.times[message];
      survey.first_time = std::min(survey.first_time, time);
      survey.last_time = std::max(survey.last_time, time);
      survey.times_hash = hash_bytes(&time, sizeof time, survey.times_hash);
      const std::array<std::uint64_t, 2> both{time, channel.hashes[message]};
      survey.hash = hash_bytes(both.data(), sizeof both, survey.hash);
    }
    take_scales(channel, scales_[i]);
  }
}

void RunSurvey::take_scales(const TraceChannel& channel, std::vector<Scale>& scales) const {
  for (std::size_t column = scales.size(); column < channel.columns.size(); ++column)
    scales.push_back({column_tolerance(channel, column, *rules_).rtol > 0.0});
  for (std::size_t column = 0; column < scales.size(); ++column)
    if (scales[column].matters)
      scales[column].largest = std::max(scales[column].largest, rehearse::scale_of(channel, column));
}

void RunSurvey::finish(const Trace& whole) {
  whole_ = &whole;
  clock.put_in_order();
}

std::size_t RunSurvey::index_of(const TraceChannel& channel) const {
  return static_cast<std::size_t>(&channel - whole_->channels().data());
}

const ChannelSurvey& RunSurvey::of(const TraceChannel& channel) const { return channels_[index_of(channel)]; }

double RunSurvey::scale_of(const TraceChannel& channel, std::size_t column) const {
  return scales_[index_of(channel)][column].largest;
}

}  // namespace rehearse
