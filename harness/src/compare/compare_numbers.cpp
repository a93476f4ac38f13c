// Comparison of tables of numbers. Most rows are equal, so the bytes of a row are compared before its numbers.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numbers>
#include <optional>

#include "compare_envelope.h"
#include "compare_parts.h"

namespace rehearse {
namespace {

/// A series of both tables, and its tolerances.
struct Column {
  std::size_t golden = 0;
  std::size_t actual = 0;
  CellKind kind = CellKind::floating;
  std::string element;
  std::string unit;
  double tolerance = 0.0;
  double noise = -1.0;  // noise floor: a difference up to it is noise; negative: unknown
  double lead = 0.0;    // [s]
  double lag = 0.0;     // [s]
  bool hash = false;
  bool wraps = false;
  const std::vector<BlankedSpan>* blanked = nullptr;   // times without judgement; null: none
  std::shared_ptr<const Envelope> envelope = nullptr;  // made at its first use
  double largest = 0.0;                                // difference so far; NaN is kept
};

/// Four columns x, y, z, w that are one orientation.
using Orientation = std::array<Column, 4>;

std::vector<std::size_t> columns_of(const Orientation& orientation) {
  std::vector<std::size_t> columns;
  for (const Column& column : orientation) columns.push_back(column.golden);
  return columns;
}

bool is_hash(const TraceChannel& channel, std::string_view element) {
  return channel.type == msg::Tick::type_name && element.ends_with("_hash");
}

/// True for the points of contacts: one of the runs may have fewer points. Then the count of contacts differs in the
/// same tick.
bool may_be_missing(const TraceChannel& channel) { return channel.type == msg::Contacts::type_name; }

/// Judges the rows of one channel.
class NumberJudge final : public PartJudge {
 public:
  NumberJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings);
  void take(const MatchedChannel& window) override;
  void take_equal(std::int64_t pairs) override;
  void finish() override;

 private:
  void match_columns();
  bool takes(const TraceChannel& channel, std::string_view element) const;
  void report_lone(const TraceChannel& channel, const ChannelSurvey& survey, const std::vector<std::string>& elements,
                   const std::string& note);
  void find_tolerance(Column& column) const;
  void group_orientations();
  void compare_cell(Column& column, std::size_t golden_row, std::size_t actual_row);
  Divergence describe(const Column& column, std::size_t golden_row, std::size_t actual_row, double difference) const;
  void mark_hash(const Column& column, std::size_t golden_row);
  double beside(Column& column, std::size_t golden_row, double actual) const;
  void compare_orientation(Orientation& orientation, std::size_t golden_row, std::size_t actual_row);
  double beside(const Orientation& orientation, std::size_t golden_row, const Quaternion& actual) const;
  void compare_norms(const Orientation& orientation, std::size_t golden_row, const Quaternion& expected,
                     const Quaternion& actual);
  bool count(const Column& column, std::size_t golden_row, double difference, bool& beyond);
  void tell(std::size_t golden_row, std::vector<std::size_t> columns, bool beyond) const;
  Divergence place(const Column& column, std::size_t golden_row, Divergence numbers = {}) const;

  const ComparedTraces& traces_;
  const PairedChannel& paired_;
  ChannelFindings& findings_;
  const MatchedChannel* window_ = nullptr;  // the judged window
  std::vector<Column> columns_;             // except those of orientations
  std::vector<Orientation> orientations_;
  bool same_columns_ = true;
};

NumberJudge::NumberJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
    : traces_(traces), paired_(channel), findings_(findings) {
  match_columns();
}

bool NumberJudge::takes(const TraceChannel& channel, std::string_view element) const {
  return channel.type != msg::Tick::type_name || element == "tick" ||
         traces_.options.takes(stage_of(channel.topic, element));
}

/// Reports all elements with this note as one finding.
void NumberJudge::report_lone(const TraceChannel& channel, const ChannelSurvey& survey,
                              const std::vector<std::string>& elements, const std::string& note) {
  constexpr std::size_t most_named = 3;
  if (elements.empty() || survey.messages == 0) return;
  std::string others;
  for (std::size_t i = 1; i < std::min(elements.size(), most_named); ++i) others += ", " + elements[i];
  if (elements.size() > most_named) others += ", ...";
  Divergence divergence = place_of(traces_, channel, survey.first_time);
  divergence.element = elements.front();
  divergence.note =
      elements.size() == 1 ? note : fmt::format("{}; {} elements in all{}", note, elements.size(), others);
  findings_.structure(divergence);
}

void NumberJudge::match_columns() {
  const TraceChannel &golden = paired_.golden, &actual = paired_.actual;
  std::map<std::string_view, std::size_t> of_actual;
  for (std::size_t i = 0; i < actual.columns.size(); ++i) of_actual.emplace(actual.columns[i].element, i);
  same_columns_ = golden.columns.size() == actual.columns.size();
  std::vector<std::string> missing, extra, of_another_kind;
  for (std::size_t i = 0; i < golden.columns.size(); ++i) {
    const TraceColumn& expected = golden.columns[i];
    const auto found = of_actual.find(expected.element);
    if (!takes(golden, expected.element)) {
      if (found != of_actual.end()) of_actual.erase(found);
      same_columns_ = false;
      continue;
    }
    if (found == of_actual.end()) {
      same_columns_ = false;
      if (!may_be_missing(golden)) missing.push_back(expected.element);
      continue;
    }
    const std::size_t at = found->second;
    of_actual.erase(found);
    same_columns_ = same_columns_ && at == i;
    if (actual.columns[at].kind != expected.kind) {
      same_columns_ = false;
      of_another_kind.push_back(expected.element);
      continue;
    }
    if (is_result_of_control(golden, expected.element)) continue;
    if (traces_.another_step && golden.type == msg::Tick::type_name && expected.element == "tick") continue;
    Column& column = columns_.emplace_back();
    column.golden = i;
    column.actual = at;
    column.kind = expected.kind;
    column.element = expected.element;
    column.unit = unit_of(golden.metadata, expected.element);
    column.hash = is_hash(golden, expected.element);
    column.wraps = golden.metadata.count("wrap:" + expected.element) > 0;
    find_tolerance(column);
  }
  if (!may_be_missing(golden))
    for (const TraceColumn& column : actual.columns)  // in this trace's order
      if (of_actual.count(column.element) && takes(actual, column.element)) extra.push_back(column.element);
  report_lone(golden, paired_.golden_survey, missing, "is missing");
  report_lone(golden, paired_.golden_survey, of_another_kind, "is a number of a different kind than in the golden");
  report_lone(actual, paired_.actual_survey, extra, "is extra: the golden hasn't it");
  group_orientations();
}

void NumberJudge::find_tolerance(Column& column) const {
  const TraceChannel& golden = paired_.golden;
  if (!traces_.blanked.empty()) {
    const bool transforms = golden.type == msg::TFMessage::type_name;
    const auto spans = traces_.blanked.find(transforms ? body_of_name(column.element)
                                                       : std::string_view(ChannelName::parse(golden.topic).body));
    if (spans != traces_.blanked.end()) column.blanked = &spans->second;
  }
  if (column.kind != CellKind::floating) return;
  const Tolerance tolerance = column_tolerance(golden, column.golden, traces_.rules);
  column.tolerance = tolerance.bound(traces_.golden_run.scale_of(golden, column.golden));
  column.lead = tolerance.lead;
  column.lag = tolerance.lag;
  const auto noise = traces_.options.noise_floors.find(series_of(golden, golden.columns[column.golden]));
  if (noise != traces_.options.noise_floors.end()) column.noise = noise->second;
}

void NumberJudge::group_orientations() {
  std::map<std::string, std::array<std::optional<Column>, 4>> found;
  constexpr std::string_view axes = "xyzw";
  const auto axis_of = [&](const Column& column) {
    const std::size_t size = column.element.size();
    if (column.unit != "quaternion" || size < 2 || column.element[size - 2] != '/') return std::string_view::npos;
    return axes.find(column.element.back());
  };
  for (const Column& column : columns_) {
    const std::size_t axis = axis_of(column);
    if (axis != std::string_view::npos) found[column.element.substr(0, column.element.size() - 2)][axis] = column;
  }
  for (const auto& [stem, parts] : found) {
    if (!parts[0] || !parts[1] || !parts[2] || !parts[3]) continue;
    orientations_.push_back({*parts[0], *parts[1], *parts[2], *parts[3]});
    std::erase_if(columns_, [&stem = stem](const Column& column) {
      return column.element.size() == stem.size() + 2 && column.element.starts_with(stem);
    });
  }
}

void NumberJudge::take_equal(std::int64_t pairs) {
  findings_.result().values += static_cast<std::int64_t>(columns_.size() + 4 * orientations_.size()) * pairs;
}

void NumberJudge::take(const MatchedChannel& window) {
  window_ = &window;
  for (Column& column : columns_) column.envelope.reset();
  take_equal(std::ssize(window.pairs));
  const std::size_t row_bytes = window.golden.columns.size() * sizeof(std::uint64_t);
  for (const auto& [golden_row, actual_row] : window.pairs) {
    if (same_columns_ && std::memcmp(window.golden.row(golden_row), window.actual.row(actual_row), row_bytes) == 0)
      continue;
    for (Column& column : columns_) compare_cell(column, golden_row, actual_row);
    for (Orientation& orientation : orientations_) compare_orientation(orientation, golden_row, actual_row);
  }
}

void NumberJudge::finish() {
  std::vector<SeriesComparison>& series = findings_.result().series;
  for (const Column& column : columns_)
    if (column.kind == CellKind::floating && !column.hash)
      series.push_back({column.element, column.unit, column.largest, column.tolerance});
  for (const Orientation& orientation : orientations_) {
    const Column& any = orientation[0];
    series.push_back({any.element.substr(0, any.element.size() - 2), "rad", any.largest, any.tolerance});
  }
}

/// NaN is more than any number.
void keep_larger(double& largest, double difference) {
  if (!(difference <= largest)) largest = std::isnan(largest) ? largest : difference;
}

/// Adds place, element, stage and unit to the numbers.
Divergence NumberJudge::place(const Column& column, std::size_t golden_row, Divergence numbers) const {
  Divergence place = place_of(traces_, window_->golden, window_->golden.times[golden_row]);
  numbers.tick = place.tick;
  numbers.time = place.time;
  numbers.channel = std::move(place.channel);
  numbers.element = column.element;
  numbers.stage = stage_of(numbers.channel, column.element);
  numbers.unit = column.unit;
  return numbers;
}

constexpr double turn = 2.0 * std::numbers::pi;  // [rad]

bool is_blanked(const std::vector<BlankedSpan>* spans, std::uint64_t time) {
  return spans && std::any_of(spans->begin(), spans->end(),
                              [time](const BlankedSpan& span) { return span.from <= time && time <= span.until; });
}

/// Counts a cell whose bits differ; true if it has to be described. Sets `beyond` to false if the cell isn't judged.
bool NumberJudge::count(const Column& column, std::size_t golden_row, double difference, bool& beyond) {
  if (difference <= column.noise) ++findings_.result().in_noise;
  if (beyond && is_blanked(column.blanked, window_->golden.times[golden_row])) {
    beyond = false;
    ++findings_.result().differing;
    ++findings_.result().blanked;
    if (!findings_.result().first_bit) {
      Divergence divergence = place(column, golden_row);
      divergence.note = "isn't judged: an event nearby is early or late within its tolerance";
      findings_.mark(divergence);
    }
    return false;
  }
  return findings_.count(difference, column.tolerance, beyond);
}

void NumberJudge::mark_hash(const Column& column, std::size_t golden_row) {
  if (findings_.result().first_bit) return;
  Divergence divergence = place(column, golden_row);
  divergence.note = "is a different hash";
  findings_.mark(divergence);
}

/// Passes a differing value to CompareOptions::on_difference.
void NumberJudge::tell(std::size_t golden_row, std::vector<std::size_t> columns, bool beyond) const {
  traces_.options.on_difference({window_->golden, window_->place(), golden_row, std::move(columns), beyond, 0});
}

/// The distance of a number from all values of the golden within lead and lag.
double NumberJudge::beside(Column& column, std::size_t golden_row, double actual) const {
  if (!column.envelope)
    column.envelope = std::make_shared<Envelope>(window_->golden, column.golden, column.lead, column.lag);
  const double expected = window_->golden.number(golden_row, column.golden);
  if (column.wraps) actual = expected + std::remainder(actual - expected, turn);
  return column.envelope->distance(golden_row, actual);
}

void NumberJudge::compare_cell(Column& column, std::size_t golden_row, std::size_t actual_row) {
  const std::uint64_t expected_bits = window_->golden.bits(golden_row, column.golden);
  const std::uint64_t actual_bits = window_->actual.bits(actual_row, column.actual);
  if (expected_bits == actual_bits) return;
  if (column.hash) return mark_hash(column, golden_row);
  double difference = 0.0;
  bool beyond = true;
  if (column.kind == CellKind::floating) {
    const double expected = std::bit_cast<double>(expected_bits), actual = std::bit_cast<double>(actual_bits);
    if (may_be_missing(window_->golden) && std::isnan(expected) != std::isnan(actual)) return;  // see may_be_missing()
    difference = difference_between(expected, actual);
    if (column.wraps) difference = std::abs(std::remainder(difference, turn));
    beyond = !(difference <= column.tolerance);
    keep_larger(column.largest, difference);
    if (beyond && (column.lead > 0.0 || column.lag > 0.0) && std::isfinite(difference)) {
      const double from_envelope = beside(column, golden_row, actual);
      beyond = !(from_envelope <= column.tolerance);
      if (!beyond) difference = from_envelope;  // the judged difference is reported
    }
  } else {
    difference = static_cast<double>(distance_of_integers(column.kind, expected_bits, actual_bits));
  }
  const bool to_describe = count(column, golden_row, difference, beyond);
  if (traces_.options.on_difference) tell(golden_row, {column.golden}, beyond);
  if (to_describe) findings_.describe(describe(column, golden_row, actual_row, difference), beyond);
}

/// Few of the cells that differ are described: a description takes longer than a comparison.
Divergence NumberJudge::describe(const Column& column, std::size_t golden_row, std::size_t actual_row,
                                 double difference) const {
  Divergence numbers;
  put_cells(numbers, column.kind, window_->golden.bits(golden_row, column.golden),
            window_->actual.bits(actual_row, column.actual));
  numbers.tolerance = column.tolerance;
  numbers.difference = difference;
  return place(column, golden_row, std::move(numbers));
}

double NumberJudge::beside(const Orientation& orientation, std::size_t golden_row, const Quaternion& actual) const {
  const auto golden_at = [&](std::size_t row) {
    Quaternion q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = window_->golden.number(row, orientation[i].golden);
    return q;
  };
  const Column& column = orientation[0];
  return distance_from_path(window_->golden.times, golden_row, column.lead, column.lag, golden_at, actual);
}

void NumberJudge::compare_orientation(Orientation& orientation, std::size_t golden_row, std::size_t actual_row) {
  Quaternion expected{}, actual{};
  std::size_t most = 4;  // the element that differs most stands for all four
  bool same_nan = true;
  for (std::size_t i = 0; i < 4; ++i) {
    expected[i] = window_->golden.number(golden_row, orientation[i].golden);
    actual[i] = window_->actual.number(actual_row, orientation[i].actual);
    same_nan = same_nan && std::isnan(expected[i]) == std::isnan(actual[i]);
    if (identical(expected[i], actual[i])) continue;
    if (most == 4 || std::abs(actual[i] - expected[i]) > std::abs(actual[most] - expected[most])) most = i;
  }
  if (most == 4) return;
  double angle = angle_between(expected, actual);
  if (std::isnan(angle) && same_nan) angle = 0.0;
  keep_larger(orientation[0].largest, angle);
  const Column& column = orientation[most];
  bool beyond = !(angle <= column.tolerance);
  if (beyond && (column.lead > 0.0 || column.lag > 0.0) && std::isfinite(angle)) {
    const double from_path = beside(orientation, golden_row, actual);
    beyond = !(from_path <= column.tolerance);
    if (!beyond) angle = from_path;
  }
  const bool to_describe = count(column, golden_row, angle, beyond);
  if (traces_.options.on_difference) tell(golden_row, columns_of(orientation), beyond);
  if (to_describe) {
    Divergence divergence = place(column, golden_row);
    put_numbers(divergence, expected[most], actual[most], "rad");
    divergence.difference = angle;
    divergence.tolerance = column.tolerance;
    findings_.describe(divergence, beyond);
  }
  compare_norms(orientation, golden_row, expected, actual);
}

/// Compares the norms: the angle has no meaning for a quaternion that is no rotation.
void NumberJudge::compare_norms(const Orientation& orientation, std::size_t golden_row, const Quaternion& expected,
                                const Quaternion& actual) {
  const double norm = norm_of(actual), wanted = norm_of(expected);
  Column column = orientation[0];
  column.tolerance = std::max(column.tolerance, default_tolerance("quaternion").atol);
  const double difference = std::abs(norm - wanted);
  if (difference <= column.tolerance || std::isnan(difference)) return;
  bool beyond = true;
  const bool to_describe = count(column, golden_row, difference, beyond);
  if (traces_.options.on_difference) tell(golden_row, columns_of(orientation), beyond);
  if (!to_describe) return;
  Divergence divergence = place(column, golden_row);
  divergence.element.back() = 'n';
  divergence.element += "orm";
  put_numbers(divergence, wanted, norm);
  divergence.tolerance = column.tolerance;
  findings_.describe(divergence, beyond);
}

}  // namespace

bool is_result_of_control(const TraceChannel& channel, std::string_view element) {
  return channel.type == msg::Tick::type_name && element.starts_with("controller_results/");
}

Tolerance column_tolerance(const TraceChannel& channel, std::size_t column, const std::vector<ToleranceRule>& rules) {
  const TraceColumn& of = channel.columns[column];
  const std::string unit = unit_of(channel.metadata, of.element);
  const bool is_range = channel.type == msg::LaserScan::type_name && of.element.starts_with("ranges/");
  const bool of_camera = channel.type == msg::CameraInfo::type_name && unit.empty();
  if (of.kind != CellKind::floating) return {};
  return tolerance_of(series_of(channel, of), is_range ? "range" : of_camera ? "camera" : unit, rules);
}

std::unique_ptr<PartJudge> judge_numbers(const ComparedTraces& traces, const PairedChannel& channel,
                                         ChannelFindings& findings) {
  return std::make_unique<NumberJudge>(traces, channel, findings);
}

}  // namespace rehearse
