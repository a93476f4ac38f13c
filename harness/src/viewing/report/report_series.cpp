#include "report_series.h"
#include "core/kinds/channel_name.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rehearse {
namespace {

/// The words of FORMAT.md for a kind of cell.
struct CellWords {
  std::string_view kind;
  std::string_view type;  // of the elements
};

const CellWords& words_of(CellKind kind) {
  static constexpr CellWords words[] = {
      {"floating", "f64"}, {"signed_integer", "i64"}, {"unsigned_integer", "u64"}, {"boolean", "u8"}};
  return words[static_cast<std::size_t>(kind)];
}

/// A column of the table as a contiguous array.
NumberArray gather(const TraceChannel& channel, std::size_t column) {
  const CellKind kind = channel.columns[column].kind;
  NumberArray array{words_of(kind).type, kind == CellKind::boolean ? std::size_t{1} : sizeof(std::uint64_t), {}};
  array.bytes.resize(channel.rows() * array.size);
  std::uint8_t* to = array.bytes.data();
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    std::uint64_t bits = channel.bits(row, column);
    for (std::size_t byte = 0; byte < array.size; ++byte, bits >>= 8) *to++ = static_cast<std::uint8_t>(bits);
  }
  return array;
}

/// Lowest and highest finite value.
struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void take(const TraceChannel& channel, std::size_t column) {
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      const double value = channel.number(row, column);
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  ReportJson json() const { return low > high ? ReportJson() : ReportJson{low, high}; }
};

/// Number of messages of equal time with different bits.
std::int64_t differing(const TraceChannel& actual, std::size_t column, const TraceChannel& golden, std::size_t other) {
  std::int64_t count = 0;
  std::size_t a = 0, g = 0;
  while (a < actual.rows() && g < golden.rows()) {
    if (actual.times[a] == golden.times[g]) {
      if (actual.bits(a, column) != golden.bits(g, other)) ++count;
      ++a;
      ++g;
    } else if (actual.times[a] < golden.times[g]) {
      ++a;
    } else {
      ++g;
    }
  }
  return count;
}

}  // namespace

std::string_view series_group(const TraceChannel& channel) {
  const ChannelName name = ChannelName::parse(channel.topic);
  if (channel.type == msg::Tick::type_name || channel.type == msg::TFMessage::type_name) return "other";
  if (name.kind == ChannelKind::variable) return "variable";
  switch (stage_of(name)) {
    case Stage::inputs: return "input";
    case Stage::controller: return "output";
    case Stage::physics: return "state";
    case Stage::sensors: return "sensor";
    case Stage::renderer: return "other";
    case Stage::costs: return "cost";
  }
  return "other";
}

std::size_t SeriesWriter::axis_of(const ReportedRun& run, const TraceChannel& channel) {
  std::vector<std::uint32_t> ticks;
  ticks.reserve(channel.rows());
  for (const std::uint64_t time : channel.times) ticks.push_back(static_cast<std::uint32_t>(run.clock.tick_at(time)));
  const auto known = std::find(axis_ticks_.begin(), axis_ticks_.end(), ticks);
  if (known != axis_ticks_.end()) return static_cast<std::size_t>(known - axis_ticks_.begin());
  bool is_dense = true;
  for (std::size_t i = 1; i < ticks.size(); ++i) is_dense = is_dense && ticks[i] == ticks[i - 1] + 1;
  if (is_dense)
    axes_.push_back({{"begin", ticks.empty() ? 0 : ticks.front()}, {"count", ticks.size()}});
  else
    axes_.push_back({{"ticks", blobs_.array(array_of(std::span<const std::uint32_t>(ticks)))}});
  axis_ticks_.push_back(std::move(ticks));
  return axis_ticks_.size() - 1;
}

void SeriesWriter::write(const TraceChannel* actual, const TraceChannel* golden) {
  const auto axis = [this](const TraceChannel* channel, const ReportedRun* run) {
    return channel && !channel->columns.empty() ? axis_of(*run, *channel) : 0;
  };
  const std::size_t actual_axis = axis(actual, &actual_), golden_axis = axis(golden, golden_);
  std::map<std::string_view, std::size_t> of_golden;
  if (golden)
    for (std::size_t i = 0; i < golden->columns.size(); ++i) of_golden.emplace(golden->columns[i].element, i);
  if (actual) {
    for (std::size_t i = 0; i < actual->columns.size(); ++i) {
      const TraceColumn& column = actual->columns[i];
      const auto other = of_golden.find(column.element);
      const bool is_alike = other != of_golden.end() && golden->columns[other->second].kind == column.kind;
      write_column({actual, i, actual_axis}, is_alike ? Column{golden, other->second, golden_axis} : Column());
      if (is_alike) of_golden.erase(other);
    }
  }
  if (!golden) return;
  for (std::size_t i = 0; i < golden->columns.size(); ++i)
    if (of_golden.count(golden->columns[i].element)) write_column({}, {golden, i, golden_axis});
}

void SeriesWriter::write_column(const Column& actual, const Column& golden) {
  const Column& either = actual.is_there() ? actual : golden;
  const TraceChannel& channel = *either.channel;
  const TraceColumn& column = channel.columns[either.index];
  ReportJson series{{"name", column.series},
                    {"topic", channel.topic},
                    {"unit", unit_of(channel.metadata, column.element)},
                    {"group", series_group(channel)},
                    {"kind", words_of(column.kind).kind},
                    {"axis", either.axis},
                    {"values", nullptr},
                    {"golden", nullptr},
                    {"tolerance", nullptr},
                    {"differing", 0},
                    {"beyond", 0}};
  Range range;
  NumberArray values;
  if (actual.is_there()) {
    values = gather(*actual.channel, actual.index);
    series["values"] = blobs_.array(values);
    range.take(*actual.channel, actual.index);
  }
  if (golden.is_there()) {
    const NumberArray expected = gather(*golden.channel, golden.index);
    const bool in_step = actual.is_there() && actual.axis == golden.axis;
    if (in_step && values.bytes == expected.bytes) {
      series["golden"] = "same";
    } else {
      series["golden"] = blobs_.array(expected, in_step ? &values : nullptr);
      range.take(*golden.channel, golden.index);
      if (actual.is_there() && !in_step) series["golden_axis"] = golden.axis;
    }
    if (actual.is_there()) {
      const JudgedValues::Column& judged = judged_->of(*golden.channel, golden.index);
      if (judged.tolerance) series["tolerance"] = *judged.tolerance;
      series["differing"] = differing(*actual.channel, actual.index, *golden.channel, golden.index);
      series["beyond"] = judged.beyond;
    }
  }
  series["range"] = range.json();
  if (channel.metadata.count("wrap:" + column.element)) series["wraps"] = true;
  series_.push_back(std::move(series));
}

}  // namespace rehearse
