#include "run_survey.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/hashing.h"
#include "core/kinds/channel_name.h"
#include "series_rules.h"
#include "series_scale.h"

namespace rehearse {

void ChannelSurvey::take(const TraceChannel& piece) {
  messages += piece.messages();
  for (const UndecodedMessage& message : piece.undecoded) {
    if (undecoded++ > 0) continue;
    first_undecoded = piece.times[message.index];
    problem = message.reason;
  }
  for (std::size_t message = 0; message < piece.messages(); ++message) {
    const std::uint64_t time = piece.times[message];
    in_order = in_order && time >= last_time;
    if (seconds.empty() || second_of(time) > seconds.back().begin)
      seconds.push_back({second_of(time), messages - piece.messages() + message, hash});
    first_time = std::min(first_time, time);
    last_time = std::max(last_time, time);
    times_hash = hash_bytes(&time, sizeof time, times_hash);
    const std::array<std::uint64_t, 2> both{time, piece.hashes[message]};
    hash = hash_bytes(both.data(), sizeof both, hash);
  }
}

std::uint64_t ChannelSurvey::messages_before(std::uint64_t second) const {
  const auto found = std::ranges::lower_bound(seconds, second, {}, &Second::begin);
  return found == seconds.end() ? messages : found->messages;
}

std::uint64_t equal_until(const ChannelSurvey& a, const ChannelSurvey& b) {
  if (!a.in_order || !b.in_order) return 0;
  const auto differing = std::ranges::mismatch(a.seconds, b.seconds).in1;
  return differing == a.seconds.begin() ? 0 : std::prev(differing)->begin;
}

void RunSurvey::take(const Trace& piece) {
  clock.take(piece);
  edges.take(piece);
  channels_.resize(piece.channels().size());
  columns_.resize(piece.channels().size());
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const TraceChannel& channel = piece.channels()[i];
    size += channel.messages() * (2 + channel.columns.size()) * sizeof(std::uint64_t);
    channels_[i].take(channel);
    take_columns(channel, columns_[i]);
  }
}

void RunSurvey::take_columns(const TraceChannel& channel, std::vector<Column>& columns) const {
  if (columns.size() < channel.columns.size()) {
    const bool may_lack = is_joint_input(ChannelName::parse(channel.topic));
    for (std::size_t column = columns.size(); column < channel.columns.size(); ++column)
      columns.push_back({column_tolerance(channel, column, *rules_).rtol > 0.0, 0.0, !may_lack});
  }
  for (std::size_t column = 0; column < columns.size(); ++column) {
    Column& of = columns[column];
    if (of.needs_scale) of.largest = std::max(of.largest, rehearse::scale_of(channel, column));
    for (std::size_t row = 0; !of.is_read && row < channel.messages(); ++row)
      of.is_read = !std::isnan(channel.number(row, column));
  }
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
  return columns_[index_of(channel)][column].largest;
}

bool RunSurvey::is_read(const TraceChannel& channel, std::size_t column) const {
  return columns_[index_of(channel)][column].is_read;
}

}  // namespace rehearse
