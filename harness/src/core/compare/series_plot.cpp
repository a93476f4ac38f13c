#include <fmt/format.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/kinds/channel_name.h"
#include "series_rules.h"

namespace rehearse {
namespace {

constexpr std::size_t label_width = 10;  // and two characters of frame

struct NumberRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool empty() const { return low > high; }
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

void add_all(NumberRange& range, const std::vector<double>& values) {
  for (const double value : values)
    if (std::isfinite(value)) range.add(value);
}

/// The ranges of time and values on the canvas, and the column or row of a number.
struct Axes {
  NumberRange time, value;
  std::size_t columns = 0, rows = 0;

  std::size_t column_of(double at) const {
    const double share = time.high > time.low ? (at - time.low) / (time.high - time.low) : 0.0;
    return std::min(columns - 1, static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(columns))));
  }
  /// Rows are counted from the top.
  std::size_t row_of(double of) const {
    // halves first: the span of two finite numbers may not be finite
    const double span = value.high / 2 - value.low / 2, above = value.high / 2 - of / 2;
    const double share = span > 0.0 ? above / span : 0.5;
    return std::min(rows - 1, static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(rows))));
  }
};

/// The range of the samples of each column. A column between samples shows the sample before it.
std::vector<NumberRange> ranges_of(const Curve& curve, const Axes& axes) {
  std::vector<NumberRange> ranges(axes.columns);
  std::vector<double> last(axes.columns, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < std::min(curve.times.size(), curve.values.size()); ++i) {
    if (!std::isfinite(curve.values[i])) continue;
    const std::size_t column = axes.column_of(curve.times[i]);
    ranges[column].add(curve.values[i]);
    last[column] = curve.values[i];
  }
  const double end = curve.times.empty() ? axes.time.low : curve.times.back();
  double held = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t column = 0; column <= axes.column_of(end); ++column) {
    if (ranges[column].empty() && std::isfinite(held)) ranges[column].add(held);
    if (std::isfinite(last[column])) held = last[column];
  }
  return ranges;
}

const char* glyph(bool golden, bool run) { return golden && run ? "▒" : golden ? "░" : run ? "█" : " "; }

/// Text in a line of blanks, moved so that it fits.
void put(std::string& line, std::size_t at, const std::string& text) {
  if (text.size() > line.size()) return;
  line.replace(std::min(at, line.size() - text.size()), text.size(), text);
}

std::string time_axis(const Axes& axes, std::optional<double> mark) {
  std::string ruler, labels(axes.columns, ' ');
  const std::size_t at = mark ? axes.column_of(*mark) : axes.columns;
  for (std::size_t column = 0; column < axes.columns; ++column) ruler += column == at ? "▲" : "─";
  put(labels, 0, fmt::format("{:.4g} s", axes.time.low));
  put(labels, axes.columns, fmt::format("{:.4g} s", axes.time.high));
  if (mark) {
    const std::string text = fmt::format("{:.6g} s", *mark);
    const std::size_t begin = at > text.size() / 2 ? at - text.size() / 2 : 0;
    const std::size_t place = std::min(begin, axes.columns - std::min(axes.columns, text.size()));
    const std::size_t from = place > 0 ? place - 1 : 0;  // a blank on either side
    const bool free = labels.substr(from, text.size() + 2).find_first_not_of(' ') == std::string::npos;
    if (free) put(labels, place, text);
  }
  while (labels.ends_with(' ')) labels.pop_back();
  const std::string margin(label_width, ' ');
  return fmt::format("{} └{}\n{}  {}\n", margin, ruler, margin, labels);
}

Curve curve_of(const TraceChannel& channel, std::size_t column) {
  Curve curve;
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    curve.times.push_back(static_cast<double>(channel.times[row]) * 1e-9);
    curve.values.push_back(channel.number(row, column));
  }
  return curve;
}

/// The element's column; of an element of several numbers (orientation) the one that differs most.
std::optional<std::size_t> worst_column(const TraceChannel& golden, const TraceChannel& run,
                                        const std::string& element) {
  if (const std::size_t exact = column_of(golden, element); exact < golden.columns.size()) return exact;
  std::optional<std::size_t> worst;
  double most = -1.0;
  for (std::size_t column = 0; column < golden.columns.size(); ++column) {
    const std::size_t other = column_of(run, golden.columns[column].element);
    if (!golden.columns[column].element.starts_with(element + "/") || other == run.columns.size()) continue;
    for (std::size_t row = 0; row < std::min(golden.rows(), run.rows()); ++row) {
      const double difference = std::abs(golden.number(row, column) - run.number(row, other));
      if (difference > most) most = difference, worst = column;
    }
  }
  return worst;
}

double times_allowed(const ChannelComparison& channel) {
  return channel.worst ? times_tolerance(channel.worst->judged(), channel.worst->tolerance) : -1.0;
}

}  // namespace

std::string plot(const Curve& golden, const Curve& run, std::optional<double> mark, PlotSize size) {
  Axes axes;
  for (const Curve* curve : {&golden, &run}) {
    add_all(axes.time, curve->times);
    add_all(axes.value, curve->values);
  }
  if (axes.value.empty() || axes.time.empty()) return "  neither curve has a number that can be drawn\n";
  axes.columns = std::max<std::size_t>(size.width, label_width + 12) - label_width - 2;
  axes.rows = std::max<std::size_t>(size.height, 2);
  const std::vector<NumberRange> of_golden = ranges_of(golden, axes), of_run = ranges_of(run, axes);
  const auto covers = [&](const NumberRange& range, std::size_t row) {
    return !range.empty() && axes.row_of(range.high) <= row && row <= axes.row_of(range.low);
  };
  std::string text;
  for (std::size_t row = 0; row < axes.rows; ++row) {
    const bool top = row == 0, bottom = row + 1 == axes.rows;
    const std::string label = top      ? fmt::format("{:.4g}", axes.value.high)
                              : bottom ? fmt::format("{:.4g}", axes.value.low)
                                       : "";
    std::string line = fmt::format("{:>{}} {}", label, label_width, top || bottom ? "┤" : "│");
    for (std::size_t column = 0; column < axes.columns; ++column)
      line += glyph(covers(of_golden[column], row), covers(of_run[column], row));
    while (line.ends_with(' ')) line.pop_back();
    text += line + '\n';
  }
  return text + time_axis(axes, mark);
}

namespace {

/// Worst first, but one of each stage before a second of any, and inputs last: they are copies of the state.
std::vector<const ChannelComparison*> in_order(const Comparison& comparison) {
  std::vector<const ChannelComparison*> worst;
  for (const ChannelComparison& channel : comparison.channels)
    if (channel.worst && channel.channel != run_topics::tick && channel.channel != run_topics::transforms)
      worst.push_back(&channel);
  std::ranges::stable_sort(worst, [](const auto* a, const auto* b) { return times_allowed(*a) > times_allowed(*b); });
  std::vector<const ChannelComparison*> order, others;
  for (const ChannelComparison* channel : worst) {
    const bool met = std::ranges::find(order, channel->stage, &ChannelComparison::stage) != order.end();
    (met || channel->stage == Stage::inputs ? others : order).push_back(channel);
  }
  order.insert(order.end(), others.begin(), others.end());
  return order;
}

/// Run minus golden, where both have a sample.
Curve difference_of(const Curve& golden, const Curve& run) {
  Curve difference;
  for (std::size_t g = 0, r = 0; g < golden.times.size() && r < run.times.size();) {
    if (golden.times[g] == run.times[r]) {
      difference.times.push_back(golden.times[g]);
      difference.values.push_back(run.values[r++] - golden.values[g++]);
    } else {
      golden.times[g] < run.times[r] ? ++g : ++r;
    }
  }
  return difference;
}

/// The two curves, or, if they would look equal, their difference.
std::string draw(const std::string& series, const Curve& golden, const Curve& run, double mark) {
  const PlotSize size;
  NumberRange values, differences;
  add_all(values, golden.values);
  add_all(values, run.values);
  const Curve difference = difference_of(golden, run);
  add_all(differences, difference.values);
  const double most = differences.empty() ? 0.0 : std::max(std::abs(differences.low), std::abs(differences.high));
  const double line = (values.high / 2 - values.low / 2) / static_cast<double>(size.height) * 2;
  if (most > 0.0 && most < line)
    return fmt::format("\n  {}: run minus golden\n{}", series, plot({}, difference, mark, size));
  return fmt::format("\n  {}: ▒ both, ░ golden, █ run\n{}", series, plot(golden, run, mark, size));
}

}  // namespace

std::string worst_plots(const Trace& golden, const Trace& run, const Comparison& comparison, std::size_t channels) {
  std::string text;
  for (const ChannelComparison* channel : in_order(comparison)) {
    if (channels == 0) break;
    const TraceChannel *of_golden = golden.find_channel(channel->channel), *of_run = run.find_channel(channel->channel);
    if (!of_golden || !of_run) continue;
    const auto column = worst_column(*of_golden, *of_run, channel->worst->element);
    if (!column) continue;
    const TraceColumn& drawn = of_golden->columns[*column];
    const std::size_t other = column_of(*of_run, drawn.element);
    if (other == of_run->columns.size()) continue;
    --channels;
    const std::string unit = unit_of(of_golden->metadata, drawn.element);
    const Divergence& first = channel->first ? *channel->first : *channel->first_bit;
    text += draw(drawn.series + (unit.empty() || unit == "quaternion" ? "" : " [" + unit + "]"),
                 curve_of(*of_golden, *column), curve_of(*of_run, other), first.time);
  }
  return text;
}

}  // namespace rehearse
