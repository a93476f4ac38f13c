#include "report_series.h"
#include "core/kinds/channel_name.h"

#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
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

ReportJson json_of(const ValueRange& range) { return range.empty() ? ReportJson() : ReportJson{range.low, range.high}; }

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

std::size_t SeriesWriter::axis_of(const ReportedRun& run, const TraceChannel& table) {
  std::vector<std::uint32_t> ticks;
  ticks.reserve(table.rows());
  for (const std::uint64_t time : table.times) ticks.push_back(static_cast<std::uint32_t>(run.clock.tick_at(time)));
  const auto known = std::ranges::find(axis_ticks_, ticks);
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

void SeriesWriter::write(const ShownChannel& channel) {
  const auto axis = [this](const TraceChannel& table, const ReportedRun* run) {
    return table.columns.empty() ? 0 : axis_of(*run, table);
  };
  const std::size_t actual_axis = axis(channel.actual, &actual_), golden_axis = axis(channel.golden, golden_);
  std::vector<bool> has_actual(channel.golden.columns.size(), false);
  const auto golden_column = [&](std::size_t index) {
    return Column{&channel.golden, index, golden_axis, &golden_->channels[*channel.pair.golden].ranges[index]};
  };
  for (std::size_t i = 0; i < channel.actual.columns.size(); ++i) {
    const Column actual{&channel.actual, i, actual_axis, &actual_.channels[*channel.pair.actual].ranges[i]};
    const std::size_t other = channel.golden_columns[i];
    if (other == ShownChannel::no_column) {
      write_column(actual, {});
      continue;
    }
    has_actual[other] = true;
    ReportJson& series = write_column(actual, golden_column(other));
    const JudgedValues::Column& judged = judged_->of(*channel.pair.golden, other);
    if (judged.tolerance) series["tolerance"] = *judged.tolerance;
    series["differing"] = channel.differing[i];
    series["beyond"] = judged.beyond;
  }
  for (std::size_t i = 0; i < channel.golden.columns.size(); ++i)
    if (!has_actual[i]) write_column({}, golden_column(i));
}

ReportJson& SeriesWriter::write_column(const Column& actual, const Column& golden) {
  const Column& either = actual.is_there() ? actual : golden;
  const TraceChannel& table = *either.table;
  const TraceColumn& column = table.columns[either.index];
  ReportJson series{{"name", column.series},
                    {"topic", table.topic},
                    {"unit", unit_of(table.metadata, column.element)},
                    {"group", series_group(table)},
                    {"kind", words_of(column.kind).kind},
                    {"axis", either.axis},
                    {"values", nullptr},
                    {"golden", nullptr},
                    {"tolerance", nullptr},
                    {"differing", 0},
                    {"beyond", 0}};
  ValueRange range;
  NumberArray values;
  if (actual.is_there()) {
    values = gather(*actual.table, actual.index);
    series["values"] = blobs_.array(values);
    range.take(*actual.range);
  }
  if (golden.is_there()) {
    const NumberArray expected = gather(*golden.table, golden.index);
    const bool in_step = actual.is_there() && actual.axis == golden.axis;
    if (in_step && values.bytes == expected.bytes) {
      series["golden"] = "same";
    } else {
      series["golden"] = blobs_.array(expected, in_step ? &values : nullptr);
      if (actual.is_there() && !in_step) series["golden_axis"] = golden.axis;
    }
    range.take(*golden.range);
  }
  series["range"] = json_of(range);
  if (table.metadata.count("wrap:" + column.element)) series["wraps"] = true;
  series_.push_back(std::move(series));
  return series_.back();
}

}  // namespace rehearse
