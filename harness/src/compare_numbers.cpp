// Tables of numbers against each other. Most rows of most comparisons are equal, so bytes are compared before numbers
// are.
#include <rehearse/messages.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <optional>

#include "compare_parts.h"

namespace rehearse {
namespace {

/// A series of both tables and how it is judged.
struct Column {
  std::size_t golden = 0;
  std::size_t actual = 0;
  CellKind kind = CellKind::floating;
  std::string element;
  std::string unit;
  double tolerance = 0.0;
  bool hash = false;
  bool wraps = false;
};

/// Four columns x, y, z, w that are one orientation.
struct Orientation {
  std::array<Column, 4> columns;
};

bool is_hash(const TraceChannel& channel, std::string_view element) {
  return channel.type == msg::Tick::type_name && element.ends_with("_hash");
}

/// A point that touches a link: one of the runs may never have had so many. The count says so, in the tick in which
/// they come apart.
bool may_be_missing(const TraceChannel& channel) { return channel.type == msg::Contacts::type_name; }

/// Judges the rows of one channel.
class NumberJudge {
 public:
  NumberJudge(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings);
  void compare_rows();

 private:
  void match_columns();
  bool takes(const TraceChannel& channel, std::string_view element) const;
  void structure(const TraceChannel& channel, const std::string& element, std::string note);
  double scale_of(std::size_t golden_column) const;
  void group_orientations();
  void compare_row(std::size_t golden_row, std::size_t actual_row);
  void compare_cell(const Column& column, std::size_t golden_row, std::size_t actual_row);
  void compare_orientation(const Orientation& orientation, std::size_t golden_row, std::size_t actual_row);
  Divergence place(const Column& column, std::size_t golden_row) const;

  const ComparedTraces& traces_;
  const MatchedChannel& channel_;
  Findings& findings_;
  std::vector<Column> columns_;  // but those of orientations
  std::vector<Orientation> orientations_;
  bool same_columns_ = true;
};

NumberJudge::NumberJudge(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings)
    : traces_(traces), channel_(channel), findings_(findings) {
  match_columns();
  findings_.result().values =
      static_cast<std::int64_t>((columns_.size() + 4 * orientations_.size()) * channel_.pairs.size());
}

void NumberJudge::structure(const TraceChannel& channel, const std::string& element, std::string note) {
  if (channel.times.empty()) return;
  Divergence divergence = place_of(traces_, channel, channel.times.front());
  divergence.element = element;
  divergence.note = std::move(note);
  findings_.structure(divergence);
}

bool NumberJudge::takes(const TraceChannel& channel, std::string_view element) const {
  return channel.type != msg::Tick::type_name || element == "tick" ||
         traces_.options.takes(stage_of(channel.topic, element));
}

void NumberJudge::match_columns() {
  const TraceChannel &golden = channel_.golden, &actual = channel_.actual;
  std::map<std::string_view, std::size_t> of_actual;
  for (std::size_t i = 0; i < actual.columns.size(); ++i) of_actual.emplace(actual.columns[i].element, i);
  same_columns_ = golden.columns.size() == actual.columns.size();
  for (std::size_t i = 0; i < golden.columns.size(); ++i) {
    const TraceColumn& expected = golden.columns[i];
    if (!takes(golden, expected.element)) {
      of_actual.erase(expected.element);
      same_columns_ = false;
      continue;
    }
    const auto found = of_actual.find(expected.element);
    if (found == of_actual.end()) {
      same_columns_ = false;
      if (!may_be_missing(golden)) structure(golden, expected.element, "is missing");
      continue;
    }
    const std::size_t at = found->second;
    of_actual.erase(found);
    same_columns_ = same_columns_ && at == i;
    if (actual.columns[at].kind != expected.kind) {
      same_columns_ = false;
      structure(golden, expected.element, "is a number of another kind than in the golden");
      continue;
    }
    columns_.push_back({i, at, expected.kind, expected.element, unit_of(golden, expected.element), 0.0,
                        is_hash(golden, expected.element), golden.metadata.count("wrap:" + expected.element) > 0});
  }
  if (!may_be_missing(golden))
    for (const auto& [element, at] : of_actual)
      if (takes(actual, element)) structure(actual, std::string(element), "is extra: the golden hasn't it");
  const bool transforms = golden.type == msg::TFMessage::type_name;  // named by the frame, like the pose of a link
  for (Column& column : columns_) {
    if (column.kind != CellKind::floating) continue;
    const std::string& series = transforms ? column.element : golden.columns[column.golden].series;
    const Tolerance tolerance = tolerance_of(series, column.unit, traces_.rules);
    column.tolerance = tolerance.bound(tolerance.rtol > 0.0 ? scale_of(column.golden) : 0.0);
  }
  group_orientations();
}

/// The largest magnitude in the golden; of an element x, y or z the largest norm of the three.
double NumberJudge::scale_of(std::size_t golden_column) const {
  const TraceChannel& golden = channel_.golden;
  const std::string& element = golden.columns[golden_column].element;
  std::vector<std::size_t> parts{golden_column};
  if (element.ends_with("/x") || element.ends_with("/y") || element.ends_with("/z")) {
    const std::string_view stem = std::string_view(element).substr(0, element.size() - 1);
    parts.clear();
    for (std::size_t i = 0; i < golden.columns.size(); ++i) {
      const std::string_view other = golden.columns[i].element;
      if (other.size() == element.size() && other.starts_with(stem) && other.back() != 'w') parts.push_back(i);
    }
  }
  double largest = 0.0;
  for (std::size_t row = 0; row < golden.rows(); ++row) {
    double squares = 0.0;
    for (const std::size_t part : parts) squares += golden.number(row, part) * golden.number(row, part);
    if (std::isfinite(squares)) largest = std::max(largest, squares);
  }
  return std::sqrt(largest);
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
    orientations_.push_back({{*parts[0], *parts[1], *parts[2], *parts[3]}});
    std::erase_if(columns_, [&stem = stem](const Column& column) {
      return column.element.size() == stem.size() + 2 && column.element.starts_with(stem);
    });
  }
}

void NumberJudge::compare_rows() {
  const TraceChannel &golden = channel_.golden, &actual = channel_.actual;
  const std::size_t row_bytes = golden.columns.size() * sizeof(std::uint64_t);
  if (same_columns_ && channel_.in_step && golden.cells == actual.cells) return;
  for (const auto& [golden_row, actual_row] : channel_.pairs) {
    if (same_columns_ && std::memcmp(golden.row(golden_row), actual.row(actual_row), row_bytes) == 0) continue;
    compare_row(golden_row, actual_row);
  }
}

void NumberJudge::compare_row(std::size_t golden_row, std::size_t actual_row) {
  for (const Column& column : columns_) compare_cell(column, golden_row, actual_row);
  for (const Orientation& orientation : orientations_) compare_orientation(orientation, golden_row, actual_row);
}

Divergence NumberJudge::place(const Column& column, std::size_t golden_row) const {
  Divergence divergence = place_of(traces_, channel_.golden, channel_.golden.times[golden_row]);
  divergence.element = column.element;
  divergence.stage = stage_of(divergence.channel, column.element);
  divergence.unit = column.unit;
  return divergence;
}

double angle_between_turns(double difference) { return std::abs(std::remainder(difference, 2.0 * std::numbers::pi)); }

void NumberJudge::compare_cell(const Column& column, std::size_t golden_row, std::size_t actual_row) {
  const std::uint64_t expected_bits = channel_.golden.bits(golden_row, column.golden);
  const std::uint64_t actual_bits = channel_.actual.bits(actual_row, column.actual);
  if (expected_bits == actual_bits) return;
  if (column.hash) {
    if (findings_.result().first_bit) return;
    Divergence divergence = place(column, golden_row);
    divergence.note = "isn't that of the golden";
    findings_.mark(divergence);
    return;
  }
  const double expected = channel_.golden.number(golden_row, column.golden);
  const double actual = channel_.actual.number(actual_row, column.actual);
  double difference = std::abs(actual - expected);
  bool beyond = true;
  if (column.kind == CellKind::floating) {
    if (std::isnan(expected) && std::isnan(actual)) difference = 0.0;
    if (column.wraps) difference = angle_between_turns(difference);
    beyond = !(difference <= column.tolerance);
  }
  if (!findings_.count(difference, column.tolerance, beyond)) return;
  Divergence divergence = place(column, golden_row);
  divergence.expected = expected;
  divergence.actual = actual;
  divergence.difference = difference;
  divergence.tolerance = column.tolerance;
  divergence.ulps = ulps_between(expected, actual);
  findings_.describe(divergence, beyond);
}

/// The angle of the rotation from one unit quaternion (x, y, z, w) to the other, 0 to pi [rad].
double angle_between(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  const double w = a[3] * b[3] + a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const double x = a[3] * b[0] - b[3] * a[0] - (a[1] * b[2] - a[2] * b[1]);
  const double y = a[3] * b[1] - b[3] * a[1] - (a[2] * b[0] - a[0] * b[2]);
  const double z = a[3] * b[2] - b[3] * a[2] - (a[0] * b[1] - a[1] * b[0]);
  return 2.0 * std::atan2(std::sqrt(x * x + y * y + z * z), std::abs(w));
}

void NumberJudge::compare_orientation(const Orientation& orientation, std::size_t golden_row, std::size_t actual_row) {
  std::array<double, 4> expected{}, actual{};
  std::size_t most = 4;  // the element that differs most stands for all four
  bool same_nan = true;
  for (std::size_t i = 0; i < 4; ++i) {
    expected[i] = channel_.golden.number(golden_row, orientation.columns[i].golden);
    actual[i] = channel_.actual.number(actual_row, orientation.columns[i].actual);
    same_nan = same_nan && std::isnan(expected[i]) == std::isnan(actual[i]);
    if (identical(expected[i], actual[i])) continue;
    if (most == 4 || std::abs(actual[i] - expected[i]) > std::abs(actual[most] - expected[most])) most = i;
  }
  if (most == 4) return;
  double angle = angle_between(expected, actual);
  if (std::isnan(angle) && same_nan) angle = 0.0;
  const Column& column = orientation.columns[most];
  const bool beyond = !(angle <= column.tolerance);
  if (!findings_.count(angle, column.tolerance, beyond)) return;
  Divergence divergence = place(column, golden_row);
  divergence.expected = expected[most];
  divergence.actual = actual[most];
  divergence.difference = angle;
  divergence.tolerance = column.tolerance;
  divergence.ulps = ulps_between(expected[most], actual[most]);
  divergence.unit = "rad";
  findings_.describe(divergence, beyond);
}

}  // namespace

void compare_numbers(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings) {
  NumberJudge(traces, channel, findings).compare_rows();
}

}  // namespace rehearse
