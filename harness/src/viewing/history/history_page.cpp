#include "history_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>

#include "base/replaceable.h"
#include "base/write_hint.h"
#include "viewing/report/html_text.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view page_magic = "<!doctype html><!-- a history of Rehearse -->";
constexpr double width = 260.0, height = 48.0, edge = 4.0;  // of a plot [px]

std::string title_of(const MarginPoint& point, const std::string& unit) {
  return html_text(fmt::format("{}{}{}: {:.6g} {}, tick {}", point.stamp.commit.substr(0, 12),
                               point.stamp.changed ? " with changes" : "",
                               point.stamp.date.empty() ? "" : " " + point.stamp.date, point.margin, unit, point.tick));
}

/// The margins over the commits, a dot each; its tooltip names the commit.
std::string plot_of(const MarginTrend& trend) {
  const auto [lowest, highest] = std::ranges::minmax_element(trend.points, {}, &MarginPoint::margin);
  const double low = lowest->margin, high = highest->margin;
  const double last = trend.points.size() > 1 ? static_cast<double>(trend.points.size() - 1) : 1.0;
  std::string line, dots;
  for (std::size_t i = 0; i < trend.points.size(); ++i) {
    const MarginPoint& point = trend.points[i];
    const double x = edge + (width - 2.0 * edge) * static_cast<double>(i) / last;
    const double share = high > low ? (point.margin - low) / (high - low) : 0.5;
    const double y = height - edge - (height - 2.0 * edge) * share;
    line += fmt::format("{:.1f},{:.1f} ", x, y);
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", x, y,
                        trend.jump == i ? 4 : 2, title_of(point, trend.unit));
  }
  return fmt::format("<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\"><polyline points=\"{2}\"/>{3}</svg>",
                     width, height, line, dots);
}

std::string row_of(const MarginTrend& trend) {
  std::string words;
  if (trend.drifts) words = fmt::format("<b>{}</b> (p = {:.2g})", html_text(drift_sentence(trend)), trend.chance);
  if (trend.jump) words += (words.empty() ? "" : "<br>") + html_text(jump_sentence(trend));
  const MarginPoint& last = trend.points.back();
  return fmt::format("<tr{}><td>{}<td>{}<td>{}<td>{:.4g} {}{}<td>{}\n", trend.drifts ? " class=\"drifts\"" : "",
                     html_text(trend.scenario), html_text(trend.text), plot_of(trend), last.margin,
                     html_text(trend.unit),
                     last.share ? fmt::format("<br>{:.3g} % of the bound", 100.0 * *last.share) : "", words);
}

std::string page_of(const Trends& trends) {
  std::string text = fmt::format(
      "{}\n<html lang=\"en\"><meta charset=\"utf-8\"><title>History</title>\n<style>\n{}"
      "polyline {{ fill: none; stroke: currentColor; stroke-width: 1.5 }}\ncircle {{ fill: currentColor }}\n"
      ".drifts svg {{ color: #d03030 }}\n</style>\n<h1>{}</h1>\n",
      page_magic, html_style, html_text(verdict(trends)));
  text += "<table>\n<tr><th>scenario<th>expectation<th>margin<th>the last<th>\n";
  for (const MarginTrend& trend : trends.margins) text += row_of(trend);
  text += "</table>\n";
  for (const FlakyCommit& flaky : trends.flaky) text += fmt::format("<p>{}</p>\n", html_text(flaky_sentence(flaky)));
  return text + "</html>\n";
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
