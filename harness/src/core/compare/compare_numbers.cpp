// Comparison of tables of numbers. Most rows are equal, so the bytes of a row are compared before its numbers.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <utility>

#include "channel_findings.h"
#include "core/kinds/channel_name.h"
#include "divergence_text.h"
#include "number_judge.h"
#include "series_rules.h"

namespace rehearse {
namespace {

std::vector<std::size_t> columns_of(const NumberJudge::Orientation& orientation) {
  std::vector<std::size_t> columns;
  for (const NumberJudge::Column& column : orientation) columns.push_back(column.golden);
  return columns;
}

bool is_hash(const TraceChannel& channel, std::string_view element) {
  return channel.type == msg::Tick::type_name && element.ends_with("_hash");
}

/// True for the points of contacts: one of the runs may have fewer points. Then the count of contacts differs in the
/// same tick.
bool may_be_missing(const TraceChannel& channel) { return channel.type == msg::Contacts::type_name; }

/// NaN is more than any number.
void keep_larger(double& largest, double difference) {
  if (!(difference <= largest)) largest = std::isnan(largest) ? largest : difference;
}

constexpr double turn = 2.0 * std::numbers::pi;  // [rad]

bool is_blanked(const std::vector<BlankedSpan>* spans, std::uint64_t time) {
  return spans && std::ranges::any_of(
                      *spans, [time](const BlankedSpan& span) { return span.from <= time && time <= span.until; });
}

}  // namespace

NumberJudge::NumberJudge(const NumberRules& rules, const TraceChannel& golden, const TraceChannel& actual,
                         NumberFindings& findings)
    : rules_(rules), findings_(findings) {
  match_columns(golden, actual);
}

void NumberJudge::match_columns(const TraceChannel& golden, const TraceChannel& actual) {
  const auto takes = [&](std::string_view element) { return !rules_.takes || rules_.takes(element); };
  std::map<std::string_view, std::size_t> of_actual;
  for (std::size_t i = 0; i < actual.columns.size(); ++i) of_actual.emplace(actual.columns[i].element, i);
  same_columns_ = golden.columns.size() == actual.columns.size();
  auto& [missing, extra, of_another_kind] = lone_;
  for (std::size_t i = 0; i < golden.columns.size(); ++i) {
    const TraceColumn& expected = golden.columns[i];
    const auto found = of_actual.find(expected.element);
    if (!takes(expected.element)) {
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
    if (rules_.another_step && golden.type == msg::Tick::type_name && expected.element == "tick") continue;
    Column& column = columns_.emplace_back();
    column.golden = i;
    column.actual = at;
    column.kind = expected.kind;
    column.element = expected.element;
    column.unit = unit_of(golden.metadata, expected.element);
    column.hash = is_hash(golden, expected.element);
    column.wraps = !rules_.is_exact() && golden.metadata.count("wrap:" + expected.element) > 0;
    find_tolerance(golden, column);
  }
  if (!may_be_missing(golden))
    for (const TraceColumn& column : actual.columns)  // in this trace's order
      if (of_actual.count(column.element) && takes(column.element)) extra.push_back(column.element);
  if (!rules_.is_exact()) group_orientations();
  if (rules_.joins_times) group_times(golden);
}

void NumberJudge::find_tolerance(const TraceChannel& golden, Column& column) const {
  if (rules_.blanked && !rules_.blanked->empty()) {
    const bool transforms = golden.type == msg::TFMessage::type_name;
    const auto spans = rules_.blanked->find(transforms ? body_of_name(column.element)
                                                       : std::string_view(ChannelName::parse(golden.topic).body));
    if (spans != rules_.blanked->end()) column.blanked = &spans->second;
  }
  if (column.kind != CellKind::floating || rules_.is_exact()) return;
  const Tolerance tolerance = column_tolerance(golden, column.golden, *rules_.tolerances);
  column.tolerance = tolerance.bound(rules_.scale_of ? rules_.scale_of(column.golden) : 0.0);
  column.lead = tolerance.lead;
  column.lag = tolerance.lag;
  if (!rules_.noise_floors) return;
  const auto noise = rules_.noise_floors->find(series_of(golden, golden.columns[column.golden]));
  if (noise != rules_.noise_floors->end()) column.noise = noise->second;
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

void NumberJudge::group_times(const TraceChannel& golden) {
  std::vector<Column> others;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const Column& column = columns_[i];
    const bool is_pair = i + 1 < columns_.size() && column.kind == CellKind::signed_integer &&
                         columns_[i + 1].kind == CellKind::unsigned_integer;
    const auto name = is_pair ? name_of_time(column.element, columns_[i + 1].element) : std::nullopt;
    if (!name) {
      others.push_back(column);
      continue;
    }
    TimeColumns& time = times_.emplace_back(TimeColumns{column, columns_[++i]});
    time.seconds.element = *name;
    time.seconds.unit = "s";
    if (rules_.tolerances)
      time.seconds.tolerance = tolerance_of(series_name(golden.topic, *name), "s", *rules_.tolerances).bound(0.0);
  }
  columns_ = std::move(others);
}

std::size_t NumberJudge::values() const { return columns_.size() + 4 * orientations_.size() + times_.size(); }

std::pair<double, double> NumberJudge::lead_and_lag() const {
  double lead = 0.0, lag = 0.0;
  const auto take = [&](const Column& column) {
    lead = std::max(lead, column.lead);
    lag = std::max(lag, column.lag);
  };
  std::ranges::for_each(columns_, take);
  for (const Orientation& orientation : orientations_) std::ranges::for_each(orientation, take);
  return {lead, lag};
}

double NumberJudge::tolerance(std::size_t golden_column) const {
  for (const Column& column : columns_)
    if (column.golden == golden_column) return column.tolerance;
  for (const Orientation& orientation : orientations_)
    for (const Column& column : orientation)
      if (column.golden == golden_column) return column.tolerance;
  return 0.0;
}

void NumberJudge::take(const MatchedRows& rows) {
  rows_ = &rows;
  for (Column& column : columns_) column.envelope.reset();
  const std::size_t row_bytes = rows.golden.columns.size() * sizeof(std::uint64_t);
  for (const auto& [golden_row, actual_row] : rows.pairs) {
    if (same_columns_ && std::memcmp(rows.golden.row(golden_row), rows.actual.row(actual_row), row_bytes) == 0)
      continue;
    for (Column& column : columns_) compare_cell(column, golden_row, actual_row);
    for (Orientation& orientation : orientations_) compare_orientation(orientation, golden_row, actual_row);
    for (TimeColumns& time : times_) compare_time(time, golden_row, actual_row);
  }
}

std::vector<SeriesComparison> NumberJudge::series() const {
  std::vector<SeriesComparison> series;
  for (const Column& column : columns_)
    if (column.kind == CellKind::floating && !column.hash)
      series.push_back({column.element, column.unit, column.largest, column.tolerance});
  for (const Orientation& orientation : orientations_) {
    const Column& any = orientation[0];
    series.push_back({any.element.substr(0, any.element.size() - 2), "rad", any.largest, any.tolerance});
  }
  for (const TimeColumns& time : times_)
    series.push_back({time.seconds.element, "s", time.seconds.largest, time.seconds.tolerance});
  return series;
}

/// Adds place, element, stage and unit to the numbers.
Divergence NumberJudge::place(const Column& column, std::size_t golden_row, Divergence numbers) const {
  Divergence place = findings_.place_of(rows_->golden, golden_row);
  numbers.tick = place.tick;
  numbers.time = place.time;
  numbers.channel = std::move(place.channel);
  numbers.element = column.element;
  numbers.stage = stage_of(numbers.channel, column.element);
  numbers.unit = column.unit;
  return numbers;
}

/// Counts a difference; true if it has to be described. Sets `beyond` to false if the number isn't judged.
bool NumberJudge::count(const Column& column, std::size_t golden_row, std::span<const std::size_t> columns,
                        const Distance& distance, bool& beyond) {
  DifferingNumber number{rows_->golden, golden_row, columns, distance.judged(), column.tolerance};
  number.in_noise = number.difference <= column.noise;
  number.blanked = beyond && is_blanked(column.blanked, rows_->golden.times[golden_row]);
  number.beyond = beyond = beyond && !number.blanked;
  const bool to_describe = findings_.count(number);
  if (number.blanked && to_describe) {
    Divergence divergence = place(column, golden_row);
    divergence.note = "isn't judged: an event nearby is early or late within its tolerance";
    findings_.mark(std::move(divergence));
  }
  return to_describe && !number.blanked;
}

/// The distance of a number from all values of the golden within lead and lag.
double NumberJudge::distance_from_envelope(Column& column, std::size_t golden_row, double actual) const {
  if (!column.envelope)
    column.envelope = std::make_shared<Envelope>(rows_->golden, column.golden, column.lead, column.lag);
  const double expected = rows_->golden.number(golden_row, column.golden);
  if (column.wraps) actual = expected + std::remainder(actual - expected, turn);
  return column.envelope->distance(golden_row, actual);
}

void NumberJudge::compare_cell(Column& column, std::size_t golden_row, std::size_t actual_row) {
  const std::uint64_t expected_bits = rows_->golden.bits(golden_row, column.golden);
  const std::uint64_t actual_bits = rows_->actual.bits(actual_row, column.actual);
  if (expected_bits == actual_bits) return;
  if (column.hash) {
    if (!findings_.wants_hash()) return;
    Divergence divergence = place(column, golden_row);
    divergence.note = "is a different hash";
    return findings_.mark(std::move(divergence));
  }
  Distance distance;
  bool beyond = true;
  if (column.kind == CellKind::floating) {
    const double expected = std::bit_cast<double>(expected_bits), actual = std::bit_cast<double>(actual_bits);
    if (may_be_missing(rows_->golden) && std::isnan(expected) != std::isnan(actual)) return;  // see may_be_missing()
    distance.difference = difference_between(expected, actual);
    if (column.wraps) distance.difference = std::abs(std::remainder(distance.difference, turn));
    keep_larger(column.largest, distance.difference);
    if (column.allows_for_time() && std::isfinite(distance.difference) && distance.difference > column.tolerance)
      distance.distance_from_envelope = distance_from_envelope(column, golden_row, actual);
    beyond = !(distance.judged() <= column.tolerance);
  } else {
    distance.difference = static_cast<double>(distance_of_integers(column.kind, expected_bits, actual_bits));
  }
  if (!count(column, golden_row, std::span(&column.golden, 1), distance, beyond)) return;
  Divergence numbers;
  put_cells(numbers, column.kind, expected_bits, actual_bits);
  describe(column, golden_row, std::move(numbers), distance, beyond);
}

void NumberJudge::compare_time(TimeColumns& time, std::size_t golden_row, std::size_t actual_row) {
  const auto time_in = [&](const TraceChannel& table, std::size_t row, std::size_t seconds, std::size_t nanoseconds) {
    return time_of_parts(static_cast<std::int64_t>(table.bits(row, seconds)), table.bits(row, nanoseconds));
  };
  Column& column = time.seconds;
  const std::int64_t expected = time_in(rows_->golden, golden_row, column.golden, time.nanoseconds.golden);
  const std::int64_t actual = time_in(rows_->actual, actual_row, column.actual, time.nanoseconds.actual);
  if (expected == actual) return;
  Divergence divergence;
  put_times(divergence, expected, actual);
  const Distance distance{divergence.difference};
  keep_larger(column.largest, distance.difference);
  bool beyond = distance.difference > column.tolerance;
  const std::size_t columns[] = {column.golden, time.nanoseconds.golden};
  if (count(column, golden_row, columns, distance, beyond))
    describe(column, golden_row, std::move(divergence), distance, beyond);
}

/// Few of the cells that differ are described: a description takes longer than a comparison.
void NumberJudge::describe(const Column& column, std::size_t golden_row, Divergence numbers, const Distance& distance,
                           bool beyond) {
  numbers.tolerance = column.tolerance;
  numbers.difference = distance.difference;
  numbers.distance_from_envelope = distance.distance_from_envelope;
  const std::string unit = numbers.unit;
  Divergence divergence = place(column, golden_row, std::move(numbers));
  if (!unit.empty()) divergence.unit = unit;
  findings_.describe(std::move(divergence), beyond);
}

double NumberJudge::distance_from_envelope(const Orientation& orientation, std::size_t golden_row,
                                           const Quaternion& actual) const {
  const auto golden_at = [&](std::size_t row) {
    Quaternion q{};
    for (std::size_t i = 0; i < 4; ++i) q[i] = rows_->golden.number(row, orientation[i].golden);
    return q;
  };
  const Column& column = orientation[0];
  return distance_from_path(rows_->golden.times, golden_row, column.lead, column.lag, golden_at, actual);
}

void NumberJudge::compare_orientation(Orientation& orientation, std::size_t golden_row, std::size_t actual_row) {
  Quaternion expected{}, actual{};
  std::size_t most = 4;  // the element that differs most stands for all four
  bool same_nan = true;
  for (std::size_t i = 0; i < 4; ++i) {
    expected[i] = rows_->golden.number(golden_row, orientation[i].golden);
    actual[i] = rows_->actual.number(actual_row, orientation[i].actual);
    same_nan = same_nan && std::isnan(expected[i]) == std::isnan(actual[i]);
    if (identical(expected[i], actual[i])) continue;
    if (most == 4 || std::abs(actual[i] - expected[i]) > std::abs(actual[most] - expected[most])) most = i;
  }
  if (most == 4) return;
  Distance distance{angle_between(expected, actual)};
  if (std::isnan(distance.difference) && same_nan) distance.difference = 0.0;
  keep_larger(orientation[0].largest, distance.difference);
  const Column& column = orientation[most];
  if (column.allows_for_time() && std::isfinite(distance.difference) && distance.difference > column.tolerance)
    distance.distance_from_envelope = distance_from_envelope(orientation, golden_row, actual);
  bool beyond = !(distance.judged() <= column.tolerance);
  if (count(column, golden_row, columns_of(orientation), distance, beyond)) {
    Divergence divergence;
    put_numbers(divergence, expected[most], actual[most], "rad");
    describe(column, golden_row, std::move(divergence), distance, beyond);
  }
  compare_norms(orientation, golden_row, expected, actual);
}

/// Compares the norms: the angle has no meaning for a quaternion that is no rotation.
void NumberJudge::compare_norms(const Orientation& orientation, std::size_t golden_row, const Quaternion& expected,
                                const Quaternion& actual) {
  const double norm = norm_of(actual), wanted = norm_of(expected);
  Column column = orientation[0];
  column.tolerance = std::max(column.tolerance, default_tolerance("quaternion").atol);
  const Distance distance{std::abs(norm - wanted)};
  if (distance.difference <= column.tolerance || std::isnan(distance.difference)) return;
  bool beyond = true;
  if (!count(column, golden_row, columns_of(orientation), distance, beyond)) return;
  Divergence divergence = place(column, golden_row);
  divergence.element.back() = 'n';
  divergence.element += "orm";
  put_numbers(divergence, wanted, norm);
  divergence.tolerance = column.tolerance;
  findings_.describe(std::move(divergence), beyond);
}

namespace {

/// Judges the numbers of a channel of two recordings.
class NumberPart final : public PartJudge, public NumberFindings {
 public:
  NumberPart(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
      : traces_(traces),
        findings_(findings),
        judge_(rules_of(traces, channel.golden), channel.golden, channel.actual, *this) {
    const auto& [missing, extra, of_another_kind] = judge_.lone();
    report_lone(channel.golden, channel.golden_survey, missing, "is missing");
    report_lone(channel.golden, channel.golden_survey, of_another_kind,
                "is a number of a different kind than in the golden");
    report_lone(channel.actual, channel.actual_survey, extra, "is not in the golden");
  }

  void take(const MatchedChannel& window) override {
    window_ = &window;
    take_equal(std::ssize(window.pairs));
    judge_.take({window.golden, window.actual, window.pairs});
  }
  void take_equal(std::int64_t pairs) override {
    findings_.result().values += static_cast<std::int64_t>(judge_.values()) * pairs;
  }
  void finish() override {
    const std::vector<SeriesComparison> series = judge_.series();
    findings_.result().series.insert(findings_.result().series.end(), series.begin(), series.end());
  }

  Divergence place_of(const TraceChannel& golden, std::size_t row) const override {
    return rehearse::place_of(traces_, golden, golden.times[row]);
  }
  bool count(const DifferingNumber& number) override {
    ChannelComparison& result = findings_.result();
    if (number.in_noise) ++result.in_noise;
    if (traces_.options.on_difference)
      traces_.options.on_difference({number.golden,
                                     window_->place(),
                                     number.row,
                                     {number.columns.begin(), number.columns.end()},
                                     number.beyond,
                                     0});
    if (!number.blanked) return findings_.count(number.difference, number.tolerance, number.beyond);
    ++result.differing;
    ++result.blanked;
    return !result.first_bit;
  }
  void describe(Divergence divergence, bool beyond) override { findings_.describe(divergence, beyond); }
  bool wants_hash() const override { return !findings_.result().first_bit; }
  void mark(Divergence divergence) override { findings_.mark(divergence); }

 private:
  static NumberRules rules_of(const ComparedTraces& traces, const TraceChannel& golden) {
    NumberRules rules;
    rules.tolerances = &traces.rules;
    rules.scale_of = [&](std::size_t column) { return traces.golden_run.scale_of(golden, column); };
    rules.noise_floors = &traces.options.noise_floors;
    rules.blanked = &traces.blanked;
    rules.takes = [&](std::string_view element) {
      if (golden.type != msg::Tick::type_name)
        return !traces.other_inputs.values.contains({golden.topic, std::string(element)});
      if (element == "input_hash" && traces.other_inputs.any()) return false;
      return element == "tick" || traces.options.takes(stage_of(golden.topic, element));
    };
    rules.joins_times = !traces.have_ticks();
    rules.another_step = traces.another_step;
    return rules;
  }

  /// Reports all elements with this note as one finding.
  void report_lone(const TraceChannel& channel, const ChannelSurvey& survey, const std::vector<std::string>& elements,
                   const std::string& note) {
    constexpr std::size_t most_named = 3;
    if (elements.empty() || survey.messages == 0) return;
    std::string others;
    for (std::size_t i = 1; i < std::min(elements.size(), most_named); ++i) others += ", " + elements[i];
    if (elements.size() > most_named) others += ", ...";
    Divergence divergence = rehearse::place_of(traces_, channel, survey.first_time);
    divergence.element = elements.front();
    divergence.note =
        elements.size() == 1 ? note : fmt::format("{}; {} elements in all{}", note, elements.size(), others);
    findings_.structure(divergence);
  }

  const ComparedTraces& traces_;
  ChannelFindings& findings_;
  const MatchedChannel* window_ = nullptr;  // the judged window
  NumberJudge judge_;
};

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
  return std::make_unique<NumberPart>(traces, channel, findings);
}

}  // namespace rehearse
