#include "align.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/hashing.h"
#include "base/median.h"
#include "base/names.h"
#include "core/mcap/draft.h"
#include "core/ros2msg/ros2msg.h"
#include "trace_rows.h"

namespace rehearse {
namespace {

constexpr std::size_t most_samples = 20'000;        // limit of a series during the search
constexpr double least_correlation = 0.5;           // two series with a lower correlation aren't similar
constexpr std::int64_t rare_distance = 50'000'000;  // half the usual distance of topics with few messages [ns]

// Limits of an estimated drift. A clock that is further off is no clock: the messages were published at another rate.
constexpr double most_drift = 0.005;
constexpr std::size_t fewest_pairs = 20;
constexpr std::size_t largest_content = 65'536;  // longer messages aren't looked for in the other log [bytes]

using Times = std::map<std::string, std::vector<std::int64_t>>;  // times of messages by topic, sorted [ns]
using Contents = std::map<std::string, std::vector<std::pair<std::uint64_t, std::int64_t>>>;  // hash and time by topic

struct Sample {
  std::int64_t time = 0;  // [ns]
  double value = 0.0;
};

/// The times in a message's fields that are named stamp.
class Stamps {
 public:
  explicit Stamps(const mcap::Schema* schema) {
    if (schema == nullptr || schema->encoding != "ros2msg") return;
    if (auto parsed = ros2msg::Schema::parse(schema->name, schema->data))
      decoder_ = std::make_unique<ros2msg::Decoder>(*std::move(parsed));
  }

  /// The message with stamps that are later by that time [ns].
  std::vector<std::byte> moved(mcap::Bytes payload, std::int64_t by) {
    return changed(payload, [by](std::int64_t stamp) {
      return stamp == 0 || stamp + by < 0 ? stamp : stamp + by;  // 0: no time was set
    });
  }

  /// The hash of a message without its stamps.
  std::uint64_t content(mcap::Bytes payload) {
    const std::vector<std::byte> bytes = changed(payload, [](std::int64_t) { return std::int64_t{0}; });
    return hash_bytes(bytes.data(), bytes.size());
  }

 private:
  std::vector<std::byte> changed(mcap::Bytes payload, const std::function<std::int64_t(std::int64_t)>& change) {
    std::vector<std::byte> bytes(payload.begin(), payload.end());
    if (!decoder_) return bytes;
    const bool swapped = bytes.size() > 1 && (bytes[1] & std::byte{1}) == std::byte{0};
    const auto put = [&](std::span<const std::byte> place, std::uint32_t number) {
      if (swapped == (std::endian::native == std::endian::little)) number = __builtin_bswap32(number);
      std::memcpy(bytes.data() + (place.data() - payload.data()), &number, sizeof number);
    };
    std::int64_t seconds = 0;
    std::span<const std::byte> seconds_at;
    const auto ends_as = [](std::string_view path, std::string_view end) {
      return path == end || (path.ends_with(end) && path[path.size() - end.size() - 1] == '/');
    };
    decoder_->decode(payload, [&](const ros2msg::Value& value) {
      if (value.bytes.size() != sizeof(std::uint32_t)) return;
      if (ends_as(value.path, "stamp/sec")) {
        seconds = value.integer;
        seconds_at = value.bytes;
      } else if (ends_as(value.path, "stamp/nanosec") && !seconds_at.empty()) {
        const std::int64_t stamp = seconds * second_ + static_cast<std::int64_t>(value.unsigned_integer);
        const std::int64_t other = change(stamp);
        if (other == stamp) return;
        put(seconds_at, static_cast<std::uint32_t>(other / second_));
        put(value.bytes, static_cast<std::uint32_t>(other % second_));
      }
    });
    return bytes;
  }

  static constexpr std::int64_t second_ = 1'000'000'000;  // [ns]
  std::unique_ptr<ros2msg::Decoder> decoder_;
};

Times times_of(mcap::Reader& log) {
  Times times;
  static_cast<void>(log.for_each_message([&](const mcap::Message& message) {
    times[message.channel->topic].push_back(static_cast<std::int64_t>(message.log_time));
    return true;
  }));
  for (auto& [topic, all] : times) std::ranges::sort(all);
  return times;
}

/// The messages whose content no other message of their topic has, sorted by content.
Contents contents_of(mcap::Reader& log) {
  Contents contents;
  std::map<std::uint16_t, Stamps> stamps;
  for (const auto& [id, channel] : log.channels()) stamps.try_emplace(id, log.schema_of(channel));
  static_cast<void>(log.for_each_message([&](const mcap::Message& message) {
    if (message.data.size() > largest_content) return true;
    contents[message.channel->topic].emplace_back(stamps.at(message.channel->id).content(message.data),
                                                  static_cast<std::int64_t>(message.log_time));
    return true;
  }));
  for (auto& [topic, all] : contents) {
    std::ranges::sort(all);
    std::size_t kept = 0;
    for (std::size_t i = 0, end = 0; i < all.size(); i = end) {
      for (end = i + 1; end < all.size() && all[end].first == all[i].first;) ++end;
      if (end == i + 1) all[kept++] = all[i];
    }
    all.resize(kept);
  }
  return contents;
}

std::int64_t median_interval(const std::vector<std::int64_t>& times) {
  if (times.size() < 3) return 2 * rare_distance;
  std::vector<std::int64_t> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  return upper_median(std::move(intervals));
}

/// The samples of a series, sorted by time.
Result<std::vector<Sample>> samples_of(mcap::Reader& log, const std::string& series) {
  std::map<std::uint16_t, std::unique_ptr<ChannelRows>> rows;
  for (const auto& [id, channel] : log.channels()) {
    auto made = std::make_unique<ChannelRows>(channel, log.schema_of(channel));
    if (made->has_rows()) rows[id] = std::move(made);
  }
  std::size_t missing = rows.size();
  static_cast<void>(log.for_each_message([&](const mcap::Message& message) {
    const auto channel = rows.find(message.channel->id);
    if (channel != rows.end() && channel->second->table.rows() == 0 &&
        channel->second->add(message.log_time, message.data))
      --missing;
    return missing > 0;
  }));
  std::vector<TraceChannel*> channels;
  std::vector<std::uint16_t> ids;
  for (auto& [id, one] : rows) {
    channels.push_back(&one->table);
    ids.push_back(id);
  }
  std::map<std::string, SeriesPlace, std::less<>> all;
  name_series(channels, all);
  const auto found = all.find(series);
  if (found == all.end()) {
    std::vector<std::string> names;
    for (const auto& [name, place] : all) names.push_back(name);
    return error_in(log.name(), fmt::format("it has no series '{}'", series), name_hint(series, names, "series"));
  }
  const std::uint16_t id = ids[found->second.channel];
  ChannelRows& of_series = *rows[id];
  const std::string element = of_series.table.columns[found->second.column].element;
  std::vector<Sample> samples;
  static_cast<void>(log.for_each_message(
      [&](const mcap::Message& message) {
        if (!of_series.replace(message.log_time, message.data)) return true;
        const auto& columns = of_series.table.columns;
        const auto column =
            std::ranges::find_if(columns, [&](const TraceColumn& one) { return one.element == element; });
        const double value = of_series.table.number(0, static_cast<std::size_t>(column - columns.begin()));
        if (std::isfinite(value)) samples.push_back({static_cast<std::int64_t>(message.log_time), value});
        return true;
      },
      std::span(&id, 1)));
  std::ranges::stable_sort(samples, [](const Sample& a, const Sample& b) { return a.time < b.time; });
  return samples;
}

/// The value at a time, linear between two samples; NaN outside.
double value_at(const std::vector<Sample>& samples, double time) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), time,
                                      [](const Sample& s, double t) { return static_cast<double>(s.time) < t; });
  if (after == samples.end() || (after == samples.begin() && static_cast<double>(after->time) > time))
    return std::numeric_limits<double>::quiet_NaN();
  if (static_cast<double>(after->time) == time) return after->value;
  const Sample& before = *(after - 1);
  const double fraction = (time - static_cast<double>(before.time)) / static_cast<double>(after->time - before.time);
  return before.value + fraction * (after->value - before.value);
}

/// The series at equal distances, less its mean.
std::vector<double> resampled(const std::vector<Sample>& samples, double step) {
  std::vector<double> values;
  const auto start = static_cast<double>(samples.front().time), end = static_cast<double>(samples.back().time);
  for (double time = start; time <= end; time = start + step * static_cast<double>(values.size()))
    values.push_back(value_at(samples, time));
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  return values;
}

/// The correlation of a[i] with b[i - lag] where both exist; nullopt if less than half of the shorter series overlaps.
std::optional<double> correlation_at(const std::vector<double>& a, const std::vector<double>& b, std::ptrdiff_t lag) {
  const auto size_a = static_cast<std::ptrdiff_t>(a.size()), size_b = static_cast<std::ptrdiff_t>(b.size());
  const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, lag), end = std::min(size_a, size_b + lag);
  if (2 * (end - begin) < std::min(size_a, size_b)) return std::nullopt;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::ptrdiff_t i = begin; i < end; ++i) {
    ab += a[i] * b[i - lag];
    aa += a[i] * a[i];
    bb += b[i - lag] * b[i - lag];
  }
  return aa > 0.0 && bb > 0.0 ? std::optional(ab / std::sqrt(aa * bb)) : std::nullopt;
}

/// The mean squared difference of both series after the offset.
double difference_at(const std::vector<Sample>& first, const std::vector<Sample>& second, double offset,
                     std::size_t stride) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < second.size(); i += stride) {
    const double other = value_at(first, static_cast<double>(second[i].time) + offset);
    if (std::isnan(other)) continue;
    sum += (second[i].value - other) * (second[i].value - other);
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(count);
}

/// The offset near `offset` with the least difference; the distance of the candidates falls from `step` to a
/// thousandth.
double refined(const std::vector<Sample>& first, const std::vector<Sample>& second, double offset, double step) {
  const std::size_t stride = std::max<std::size_t>(1, second.size() / most_samples);
  for (double width = step; width > step / 1000; width /= 2) {
    double best = offset;
    for (const double candidate : {offset - width, offset + width})
      if (difference_at(first, second, candidate, stride) < difference_at(first, second, best, stride))
        best = candidate;
    offset = best;
  }
  return offset;
}

Result<void> align_by_series(mcap::Reader& first, mcap::Reader& second, const std::string& series,
                             Alignment& alignment) {
  const auto a = samples_of(first, series);
  auto b = samples_of(second, series);
  if (!a) return a.errors();
  if (!b) return b.errors();
  for (Sample& sample : *b) sample.time = alignment.without_drift(sample.time);
  if (a->size() < 3 || b->size() < 3)
    return error(fmt::format("the series '{}' has fewer than three numbers in one of the logs", series));
  std::vector<std::int64_t> times;
  for (const Sample& sample : *a) times.push_back(sample.time);
  const double span = static_cast<double>(std::max(a->back().time - a->front().time, b->back().time - b->front().time));
  const double step =
      std::max({static_cast<double>(median_interval(times)), span / static_cast<double>(most_samples), 1.0});
  const std::vector<double> values_a = resampled(*a, step), values_b = resampled(*b, step);
  std::optional<double> best;
  std::ptrdiff_t best_lag = 0;
  for (std::ptrdiff_t lag = 1 - std::ssize(values_b); lag < std::ssize(values_a); ++lag) {
    const auto here = correlation_at(values_a, values_b, lag);
    if (here && (!best || *here > *best)) best = here, best_lag = lag;
  }
  if (!best)
    return error(fmt::format("the series '{}' doesn't vary in one of the logs", series), "name a different series");
  if (*best < least_correlation)
    return error(
        fmt::format("the series '{}' isn't similar in both logs: its correlation is at most {:.2f}", series, *best),
        "name a different series, or start");
  const double coarse = static_cast<double>(a->front().time - b->front().time) + static_cast<double>(best_lag) * step;
  alignment.offset = std::llround(refined(*a, *b, coarse, step));
  alignment.correlation = best;
  return {};
}

Result<void> align_by_start(const Times& first, const Times& second, Alignment& alignment) {
  std::optional<std::int64_t> start_a, start_b;
  for (const auto& [topic, times] : first) {
    const auto other = second.find(topic);
    if (other == second.end()) continue;
    start_a = std::min(start_a.value_or(times.front()), times.front());
    start_b = std::min(start_b.value_or(other->second.front()), other->second.front());
  }
  if (!start_a) return error("the logs have no topic in common", "nothing can be aligned");
  alignment.offset = *start_a - *start_b;
  return {};
}

/// A message of the second log, and the same message of the first log [ns].
struct TimePair {
  std::int64_t second = 0, first = 0;
};

std::vector<TimePair> pairs_of_equal_content(mcap::Reader& first, mcap::Reader& second) {
  const Contents contents_a = contents_of(first), contents_b = contents_of(second);
  std::vector<TimePair> pairs;
  for (const auto& [topic, all] : contents_b) {
    const auto other = contents_a.find(topic);
    if (other == contents_a.end()) continue;
    auto a = other->second.begin();
    for (const auto& [content, time] : all) {
      while (a != other->second.end() && a->first < content) ++a;
      if (a != other->second.end() && a->first == content) pairs.push_back({time, a->second});
    }
  }
  return pairs;
}

/// The nearest messages, of the common topic with the most messages. The offset follows them: each pair moves it by a
/// tenth of its distance. So a drift of many intervals is found, and a single wrong time does nothing.
std::vector<TimePair> pairs_in_order(const Times& first, const Times& second, std::int64_t offset) {
  const std::vector<std::int64_t>*a = nullptr, *b = nullptr;
  for (const auto& [topic, times] : second) {
    const auto other = first.find(topic);
    if (other == first.end() || (b && std::min(a->size(), b->size()) >= std::min(other->second.size(), times.size())))
      continue;
    a = &other->second;
    b = &times;
  }
  std::vector<TimePair> pairs;
  if (!b) return pairs;
  const std::int64_t limit = median_interval(*a) / 2;
  std::size_t next = 0;
  for (const std::int64_t time : *b) {
    const std::int64_t moved = time + offset;
    while (next + 1 < a->size() && std::abs((*a)[next + 1] - moved) < std::abs((*a)[next] - moved)) ++next;
    const std::int64_t distance = (*a)[next] - moved;
    if (std::abs(distance) > limit) continue;
    pairs.push_back({time, (*a)[next]});
    offset += distance / 10;
  }
  return pairs;
}

/// Sets the drift of the second clock, and its offset, if the pairs show a drift: over the log it moves messages by
/// more than the pairs are apart without it. Slopes are those between pairs half of the log apart; the medians of
/// slopes and of distances make a few wrong times harmless.
bool find_drift(std::vector<TimePair> pairs, Alignment& alignment) {
  if (pairs.size() < fewest_pairs) return false;
  std::ranges::stable_sort(pairs, {}, &TimePair::second);
  std::vector<double> slopes, offsets, distances;
  const std::size_t half = pairs.size() / 2;
  for (std::size_t i = 0; i + half < pairs.size(); ++i) {
    const TimePair &from = pairs[i], &to = pairs[i + half];
    if (to.second > from.second)
      slopes.push_back(static_cast<double>(to.first - from.first) / static_cast<double>(to.second - from.second) - 1.0);
  }
  if (slopes.empty()) return false;
  Alignment found = alignment;
  found.drift = upper_median(slopes);
  for (const auto& [second, first] : pairs)
    offsets.push_back(static_cast<double>(first - pairs[0].first - (found.without_drift(second) - pairs[0].second)));
  const double middle = upper_median(offsets);
  for (const double offset : offsets) distances.push_back(std::abs(offset - middle));
  const double moved = std::abs(found.drift) * static_cast<double>(pairs.back().second - pairs.front().second);
  constexpr double rounding = 1000.0;  // [ns]
  if (std::abs(found.drift) > most_drift || moved < 4.0 * upper_median(distances) + rounding) return false;
  found.offset = pairs[0].first - pairs[0].second + std::llround(middle);
  found.drift_pairs = pairs.size();
  alignment = found;
  return true;
}

/// Estimates drift and offset anew. Messages of equal content tell most; without these, the distances of messages do.
Result<void> align_drift(mcap::Reader& first, mcap::Reader& second, const std::string& by, const Times& times_a,
                         const Times& times_b, Alignment& alignment) {
  for (const auto& [topic, times] : times_b)
    if (times_a.contains(topic)) alignment.start = std::min(alignment.start, times.front());
  alignment.by_content = true;
  const std::vector<TimePair> equal = pairs_of_equal_content(first, second);
  if (equal.size() < fewest_pairs) alignment.by_content = false;
  const std::vector<TimePair> pairs = alignment.by_content ? equal : pairs_in_order(times_a, times_b, alignment.offset);
  if (!find_drift(pairs, alignment) || by == "start") return {};
  const std::int64_t by_pairs = alignment.offset;
  REHEARSE_TRY(align_by_series(first, second, by, alignment));
  std::vector<std::int64_t> times;
  for (const TimePair& pair : pairs) times.push_back(pair.second);
  std::ranges::sort(times);
  // pairs may be one message off; else their median is better than a mean, which a wrong time moves
  if (std::abs(by_pairs - alignment.offset) < median_interval(times) / 2) alignment.offset = by_pairs;
  return {};
}

/// The new times of a topic's messages in the second log: the times of the matched messages in the first log, else the
/// old times by the clock of the first.
std::vector<std::int64_t> matched_times(const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second,
                                        Alignment& alignment, std::vector<std::int64_t>& distances) {
  const std::int64_t limit = median_interval(first) / 2;
  std::vector<std::int64_t> times;
  std::size_t next = 0;
  const std::uint64_t matched_before = alignment.matched;
  for (const std::int64_t time : second) {
    const std::int64_t moved = alignment.time_of(time);
    const auto distance = [&](std::size_t i) { return std::abs(first[i] - moved); };
    while (next + 1 < first.size() && distance(next + 1) < distance(next)) ++next;
    if (next < first.size() && distance(next) <= limit) {
      distances.push_back(distance(next));
      times.push_back(first[next++]);
      ++alignment.matched;
    } else {
      times.push_back(moved);
      ++alignment.lone_second;
    }
  }
  alignment.lone_first += first.size() - (alignment.matched - matched_before);
  return times;
}

Result<void> write_moved(mcap::Reader& log, mcap::Writer& writer,
                         std::map<std::string, std::vector<std::int64_t>> times, Alignment& alignment) {
  std::map<std::uint16_t, std::uint16_t> ids;
  std::map<std::uint16_t, Stamps> movers;
  std::map<std::string, std::size_t> next;  // index of the next time, by topic
  for (const auto& [id, channel] : log.channels()) {
    const mcap::Schema* schema = log.schema_of(channel);
    ids[id] = writer.add_channel(mcap::copy(schema, writer), channel.topic, channel.message_encoding, channel.metadata);
    movers.try_emplace(id, schema);
  }
  for (const mcap::Attachment& attachment : log.attachments()) REHEARSE_TRY(mcap::copy(attachment, writer));
  for (const mcap::Metadata& metadata : log.metadata())
    REHEARSE_TRY(writer.add_metadata(metadata.name, metadata.values));
  Result<void> written;
  const Result<void> read = log.for_each_message_in_order([&](const mcap::Message& message) {
    const std::string& topic = message.channel->topic;
    const auto of_topic = times.find(topic);
    const auto old = static_cast<std::int64_t>(message.log_time);
    const std::int64_t time = of_topic == times.end() ? alignment.time_of(old) : of_topic->second[next[topic]++];
    if (time < 0) return ++alignment.left_out > 0;
    const auto published = static_cast<std::int64_t>(message.publish_time) + time - old;
    written = writer.write(ids[message.channel->id], static_cast<std::uint64_t>(time),
                           static_cast<std::uint64_t>(std::max<std::int64_t>(published, 0)),
                           movers.at(message.channel->id).moved(message.data, time - old), message.sequence);
    return written.ok();
  });
  if (!written) return written;
  if (!read) return read;
  return writer.close();
}

}  // namespace

Result<Alignment> write_aligned(const std::filesystem::path& first, const std::filesystem::path& second,
                                const std::string& by, const std::filesystem::path& target) {
  const auto a = REHEARSE_TRY(mcap::Reader::open(first));
  const auto b = REHEARSE_TRY(mcap::Reader::open(second));
  const Times times_a = times_of(*a), times_b = times_of(*b);
  Alignment alignment;
  REHEARSE_TRY(by == "start" ? align_by_start(times_a, times_b, alignment) : align_by_series(*a, *b, by, alignment));
  REHEARSE_TRY(align_drift(*a, *b, by, times_a, times_b, alignment));
  Times moved;
  std::vector<std::int64_t> distances;
  for (const auto& [topic, times] : times_b)
    if (const auto other = times_a.find(topic); other != times_a.end())
      moved[topic] = matched_times(other->second, times, alignment, distances);
  if (!distances.empty()) {
    alignment.median_distance = static_cast<double>(upper_median(distances)) * 1e-9;
    alignment.largest_distance = static_cast<double>(*std::ranges::max_element(distances)) * 1e-9;
  }
  mcap::WriterOptions form;
  form.profile = b->profile();
  form.compression = mcap::Compression::lz4;
  auto writer = REHEARSE_TRY(mcap::Writer::create(target, form));
  REHEARSE_TRY(write_moved(*b, *writer, std::move(moved), alignment));
  return alignment;
}

}  // namespace rehearse
