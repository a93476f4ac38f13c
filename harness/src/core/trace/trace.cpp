#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/trace.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "message_rest.h"

namespace rehearse {

/// The samples of a series that exists and has at least one sample.
struct Trace::Samples {
  const TraceChannel& channel;
  std::size_t column;

  std::size_t count() const { return channel.rows(); }
  double operator[](std::size_t i) const { return channel.number(i, column); }
  double time(std::size_t i) const { return static_cast<double>(channel.times[i]) * 1e-9; }
};

namespace {

/// Converts a test's argument to a time in the trace's units, so that rounding doesn't change the selected sample.
std::uint64_t to_ns(double seconds) {
  if (!(seconds > 0.0)) return 0;
  constexpr double limit = 1e10;  // [s], 300 years
  return static_cast<std::uint64_t>(std::llround(std::min(seconds, limit) * 1e9));
}

/// The number of letters to change, add or remove to convert one text to the other. A * in the first matches any text
/// at no cost.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == '*') {
      for (std::size_t j = 0; j < b.size(); ++j) row[j + 1] = std::min(row[j + 1], row[j]);
      continue;
    }
    std::size_t diagonal = std::exchange(row[0], row[0] + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<SeriesPlace> Trace::find_series(std::string_view name) const {
  const auto found = series_.find(name);
  if (found == series_.end()) return std::nullopt;
  return found->second;
}

std::string Trace::nearest_series(std::string_view name) const {
  constexpr std::size_t shown = 3, longest = 200;  // bytes: no name is longer; it limits the time for long texts
  name = name.substr(0, longest);
  std::vector<std::pair<std::size_t, std::string_view>> by_distance;
  for (const auto& [other, place] : series_) by_distance.emplace_back(edit_distance(name, other), other);
  const std::size_t count = std::min(shown, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(count), by_distance.end());
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    text += by_distance[i].second;
  }
  return text;
}

Trace::Samples Trace::samples(std::string_view name, const CallPlace& from) const {
  const auto place = find_series(name);
  if (!place) {
    throw std::out_of_range(message_at(
        from, series_.empty()
                  ? fmt::format("{} has no series at all, so it lacks \"{}\"", file_, name)
                  : fmt::format("{} has no series \"{}\"; the nearest are {}", file_, name, nearest_series(name))));
  }
  return {channels_[place->channel], place->column};
}

double Trace::first(std::string_view series, const CallPlace& from) const { return samples(series, from)[0]; }

double Trace::last(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  return all[all.count() - 1];
}

double Trace::min(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  double least = all[0];
  for (std::size_t i = 1; i < all.count(); ++i) {
    if (all[i] < least || std::isnan(all[i])) least = all[i];
  }
  return least;
}

double Trace::max(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  double most = all[0];
  for (std::size_t i = 1; i < all.count(); ++i) {
    if (all[i] > most || std::isnan(all[i])) most = all[i];
  }
  return most;
}

double Trace::mean(std::string_view series, double from_s, double until_s, const CallPlace& from) const {
  const Samples all = samples(series, from);
  const std::uint64_t begin = to_ns(from_s), end = to_ns(until_s);
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < all.count(); ++i) {
    if (all.channel.times[i] < begin || all.channel.times[i] >= end) continue;
    sum += all[i];
    ++count;
  }
  if (count == 0)
    throw std::out_of_range(
        message_at(from, fmt::format("\"{}\" has no sample from {} s until {} s", series, from_s, until_s)));
  return sum / static_cast<double>(count);
}

double Trace::at(std::string_view series, double time_s, const CallPlace& from) const {
  const Samples all = samples(series, from);
  const std::uint64_t time = to_ns(time_s);
  std::optional<std::size_t> latest;
  for (std::size_t i = 0; i < all.count(); ++i) {
    const std::uint64_t t = all.channel.times[i];
    if (t <= time && (!latest || all.channel.times[*latest] <= t)) latest = i;
  }
  if (!latest)
    throw std::out_of_range(message_at(from, fmt::format("\"{}\" has no sample at {} s or before", series, time_s)));
  return all[*latest];
}

std::vector<double> Trace::values(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  std::vector<double> values(all.count());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = all[i];
  return values;
}

std::vector<double> Trace::times(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  std::vector<double> times(all.count());
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = all.time(i);
  return times;
}

std::vector<std::uint64_t> Trace::integers(std::string_view series, const CallPlace& from) const {
  const Samples all = samples(series, from);
  if (all.channel.columns[all.column].kind == CellKind::floating) {
    throw std::invalid_argument(message_at(from, fmt::format("\"{}\" isn't a series of integers", series)));
  }
  std::vector<std::uint64_t> values(all.count());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = all.channel.bits(i, all.column);
  return values;
}

double Trace::duration() const {
  std::uint64_t earliest = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t latest = 0;
  for (const TraceChannel& channel : channels_) {
    for (const std::uint64_t time : channel.times) {
      earliest = std::min(earliest, time);
      latest = std::max(latest, time);
    }
  }
  return earliest > latest ? 0.0 : static_cast<double>(latest - earliest) * 1e-9;
}

std::int64_t Trace::ticks() const {
  for (const TraceChannel& channel : channels_) {
    if (channel.type == msg::Tick::type_name) return static_cast<std::int64_t>(channel.messages());
  }
  return 0;
}

const TraceChannel* Trace::find_channel(std::string_view topic) const {
  for (const TraceChannel& channel : channels_) {
    if (channel.topic == topic) return &channel;
  }
  return nullptr;
}

const std::vector<msg::ContactChange>& Trace::contact_changes() const { return *contact_changes_; }

const std::vector<mcap::Attachment>& Trace::attachments() const { return reader_->attachments(); }

const mcap::Attachment* Trace::find_attachment(std::string_view name) const {
  for (const mcap::Attachment& attachment : attachments()) {
    if (attachment.name == name) return &attachment;
  }
  return nullptr;
}

const std::vector<mcap::Metadata>& Trace::metadata() const { return reader_->metadata(); }

const mcap::StringMap* Trace::find_metadata(std::string_view name) const {
  for (const mcap::Metadata& entry : metadata()) {
    if (entry.name == name) return &entry.values;
  }
  return nullptr;
}

Result<std::vector<std::byte>> Trace::payload(const TraceChannel& channel, std::size_t index) const {
  REHEARSE_ASSERT(index < channel.locations.size(), "the channel keeps locations, and has that many messages");
  const auto message = REHEARSE_TRY(reader_->message_at(channel.locations[index]));
  return std::vector<std::byte>(message.data.begin(), message.data.end());
}

const mcap::Schema* Trace::schema_of(const TraceChannel& channel) const {
  // channels() has the channels of the file in the file's order
  auto described = reader_->channels().begin();
  std::advance(described, &channel - channels_.data());
  return reader_->schema_of(described->second);
}

struct Trace::Rests {
  std::map<std::size_t, std::unique_ptr<MessageRest>> by_channel;
};

Result<std::vector<std::byte>> Trace::rest(const TraceChannel& channel, std::size_t index) const {
  if (!rests_) rests_ = std::make_shared<Rests>();
  auto& maker = rests_->by_channel[static_cast<std::size_t>(&channel - channels_.data())];
  if (!maker) maker = MessageRest::make(channel.type, channel.encoding, schema_of(channel));
  const TraceRest* rest = channel.rest_of(index);
  REHEARSE_ASSERT(maker != nullptr && rest != nullptr, "only a channel whose schema is known has rests");
  const auto message = REHEARSE_TRY(reader_->message_at(rest->location));
  maker->take(message.data, message.log_time);
  return maker->bytes_at(channel.times[index]);
}

}  // namespace rehearse
