#include "history_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/replaceable.h"
#include "base/write_hint.h"
#include "viewing/report/html_text.h"
#include "viewing/report/small_page.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view page_magic = "<!doctype html><!-- a history of Rehearse -->";
constexpr double nearest_label = 13.0;  // distance of labels at the axis up [% of the chart]
constexpr double nearest_date = 13.0;   // likewise of those across
constexpr double near_date = 33.0;      // on a telephone

std::string commit_text(const HistoryStamp& stamp) {
  return fmt::format("{}{}", stamp.commit.empty() ? "no commit" : stamp.commit.substr(0, 7), stamp.changed ? "+" : "");
}

std::string day_of(const HistoryStamp& stamp) { return stamp.date.substr(0, 10); }

/// A point in words.
std::string point_text(const MarginPoint& point, const std::string& unit) {
  std::string text =
      fmt::format("{}{}{}{}: margin {}", point.stamp.commit.empty() ? "" : "commit ", commit_text(point.stamp),
                  point.stamp.date.empty() ? "" : ", ", day_of(point.stamp), with_unit(point.margin, unit));
  if (point.share) text += fmt::format(", {:.3g} % of the bound", 100.0 * *point.share);
  return text + fmt::format(", value {} at tick {}", with_unit(point.value, unit), point.tick);
}

/// The axis up of a chart: margins, and the bound at a margin of 0.
class MarginAxis {
 public:
  explicit MarginAxis(const std::vector<MarginPoint>& points) {
    const auto [lowest, highest] = std::ranges::minmax_element(points, {}, &MarginPoint::margin);
    low = lowest->margin;
    high = highest->margin;
    const bool is_far = low > 0.0 && high - low < 0.15 * high;
    is_broken = is_far;
    begin_ = is_far ? low : std::min(low, 0.0);
    end_ = std::max(high, 0.0);
    if (end_ == begin_) end_ = begin_ + 1.0;
  }

  /// The height of a margin [%]. Of a broken axis the lowest part belongs to the bound alone.
  double height_of(double margin) const {
    if (!is_broken) return 6.0 + 86.0 * (margin - begin_) / (end_ - begin_);
    return high > low ? 30.0 + 62.0 * (margin - low) / (high - low) : 60.0;
  }
  double height_of_bound() const { return is_broken ? 6.0 : height_of(0.0); }

  double low = 0.0, high = 0.0;
  bool is_broken = false;  // all margins are far from the bound, beside their differences

 private:
  double begin_ = 0.0, end_ = 1.0;
};

double place_of(std::size_t point, std::size_t count) {
  return count > 1 ? 2.0 + 96.0 * static_cast<double>(point) / static_cast<double>(count - 1) : 50.0;
}

std::string labels_up(const MarginTrend& trend, const MarginAxis& axis) {
  std::string text;
  const auto add = [&text](double height, std::string_view kind, const std::string& label) {
    text += fmt::format("<span{} style=\"bottom:{:.1f}%\">{}</span>", kind, height, html_text(label));
  };
  const double bound = axis.height_of_bound();
  add(bound, " class=\"bound\"", "bound");
  if (axis.is_broken) add(18.0, "", "≈");
  std::vector<double> taken{bound};
  for (const double margin : {axis.high, axis.low}) {
    const double height = axis.height_of(margin);
    if (std::ranges::any_of(taken, [&](double other) { return std::abs(other - height) < nearest_label; })) continue;
    add(height, "", with_unit(margin, trend.unit));
    taken.push_back(height);
  }
  return text;
}

std::string labels_across(const MarginTrend& trend) {
  const std::size_t count = trend.points.size();
  std::string text;
  const auto add = [&](std::size_t point, std::string_view kind) {
    const HistoryStamp& stamp = trend.points[point].stamp;
    text += fmt::format("<span class=\"{}\" style=\"left:{:.2f}%\">{}<br>{}</span>", kind, place_of(point, count),
                        html_text(commit_text(stamp)), html_text(day_of(stamp)));
  };
  std::vector<std::size_t> labelled;
  const auto is_near = [&](std::size_t point, double distance) {
    return std::ranges::any_of(labelled, [&](std::size_t other) {
      return std::abs(place_of(point, count) - place_of(other, count)) < distance;
    });
  };
  const auto label = [&](std::size_t point, const std::string& kind) {
    if (is_near(point, nearest_date)) return;
    add(point, is_near(point, near_date) ? kind + " near" : kind);
    labelled.push_back(point);
  };
  if (trend.jump) label(*trend.jump, *trend.jump + 1 == count ? "newest jump" : "jump");
  label(count - 1, count > 1 ? "newest" : "middle");
  label(0, "first");
  label(count / 2, "middle");
  return text;
}

/// The margins over the commits: a line, a dot each, the bound as a rule, and the jump's commit as another.
std::string chart_of(const MarginTrend& trend) {
  const MarginAxis axis(trend.points);
  const std::size_t count = trend.points.size();
  std::string line, dots, rules;
  for (std::size_t i = 0; i < count; ++i) {
    const MarginPoint& point = trend.points[i];
    const double x = place_of(i, count), y = 100.0 - axis.height_of(point.margin);
    line += fmt::format("{:.2f},{:.2f} ", x, y);
    dots += fmt::format("<circle{} cx=\"{:.2f}%\" cy=\"{:.2f}%\" r=\"{}\" data-text=\"{}\"/>",
                        point.margin < 0.0 ? " class=\"violated\""
                        : trend.jump == i  ? " class=\"jump\""
                                           : "",
                        x, y, trend.jump == i ? 5 : 3, html_text(point_text(point, trend.unit)));
  }
  const double bound = 100.0 - axis.height_of_bound();
  rules += fmt::format("<line class=\"rule\" x1=\"0\" x2=\"100%\" y1=\"{0:.2f}%\" y2=\"{0:.2f}%\"/>", bound);
  if (trend.jump)
    rules += fmt::format("<line class=\"jump\" x1=\"{0:.2f}%\" x2=\"{0:.2f}%\" y1=\"0\" y2=\"100%\"/>",
                         place_of(*trend.jump, count));
  const std::string last = html_text(point_text(trend.points.back(), trend.unit));
  return fmt::format(
      "<div class=\"chart\"><div class=\"up\">{0}</div>\n<div class=\"area\" role=\"slider\" tabindex=\"0\" "
      "aria-label=\"margin over commits: arrow keys select one\" aria-valuemin=\"1\" aria-valuemax=\"{1}\" "
      "aria-valuenow=\"{1}\" aria-valuetext=\"{2}\"><svg aria-hidden=\"true\">{3}<svg viewBox=\"0 0 100 100\" "
      "width=\"100%\" height=\"100%\" preserveAspectRatio=\"none\"><polyline class=\"line\" points=\"{4}\"/></svg>{5}"
      "</svg><div class=\"hand\" hidden></div></div>\n<div class=\"across\">{6}</div>\n<output>{2}{7}</output></div>\n",
      labels_up(trend, axis), count, last, rules, line, dots, labels_across(trend),
      axis.is_broken ? "; the bound is farther away than drawn" : "");
}

std::string section_of(const MarginTrend& trend) {
  const MarginPoint& last = trend.points.back();
  std::string text = fmt::format(
      "<section class=\"panel trend\"{} aria-label=\"{}: {}\">\n<header><h2>{}</h2><span class=\"note\">{}</span>"
      "<span class=\"last\"><b>{}</b>{}</span></header>\n",
      trend.drifts || trend.jump ? " data-finding" : "", html_text(trend.scenario), html_text(trend.text),
      html_text(trend.text), html_text(trend.scenario), html_text(with_unit(last.margin, trend.unit)),
      last.share ? fmt::format(" <span class=\"note\">{:.3g} % of the bound</span>", 100.0 * *last.share) : "");
  if (trend.drifts)
    text +=
        fmt::format("<p><b class=\"bad\">{}</b> (p = {:.2g})</p>\n", html_text(drift_sentence(trend)), trend.chance);
  if (trend.jump) text += fmt::format("<p>{}</p>\n", html_text(jump_sentence(trend)));
  return text + chart_of(trend) + "</section>\n";
}

std::string page_of(const Trends& trends) {
  std::string content;
  for (const FlakyCommit& flaky : trends.flaky)
    content += fmt::format("<section class=\"panel\" data-finding><h2 class=\"bad\">{}</h2></section>\n",
                           html_text(flaky_sentence(flaky)));
  std::vector<const MarginTrend*> order;  // what drifts comes first, then what jumps
  for (const MarginTrend& trend : trends.margins) order.push_back(&trend);
  std::ranges::stable_sort(order, {}, [](const MarginTrend* trend) { return trend->drifts ? 0 : trend->jump ? 1 : 2; });
  for (const MarginTrend* trend : order) content += section_of(*trend);
  return small_page({.magic = page_magic,
                     .kind = "History",
                     .is_bad = trends.drifts() || !trends.flaky.empty(),
                     .title = verdict(trends),
                     .content = content});
}

}  // namespace

Result<void> write_history_page(const Trends& trends, const fs::path& file) {
  REHEARSE_TRY(check_replaceable(file, page_magic, "history"));
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << page_of(trends);
  stream.close();
  if (!stream) return error_in(file.string(), "it can't be written", write_hint(file, "name another file with --html"));
  return {};
}

}  // namespace rehearse
