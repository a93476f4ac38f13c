// The pictures of a campaign's page: distributions, and dots of cases over two parameters.
#include "campaign_pictures.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "axis.h"
#include "case_articles.h"
#include "viewing/report/html_text.h"

namespace rehearse {
namespace {

constexpr std::size_t bins = 20;  // of a histogram
constexpr std::size_t most_pairs = 6;
constexpr std::size_t most_labels = 8;           // words at an axis
constexpr double width = 260.0, height = 150.0;  // of a picture without its words [px]

/// The first letters of a word that is longer [bytes].
std::string shortened(const std::string& word, std::size_t most) {
  std::size_t end = std::min(word.size(), most);
  while (end < word.size() && (static_cast<unsigned char>(word[end]) & 0xC0) == 0x80) --end;  // within a letter
  return word.substr(0, end) + (end < word.size() ? "..." : "");
}

/// The words at an axis of a picture: its name in the middle, and the ends of its range; empty: words have no ends.
struct AxisWords {
  std::string name, low = {}, high = {};
};

std::string axis_text(double x, double y, const char* anchor, const std::string& word) {
  return fmt::format("<text class=\"axis\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                     html_text(word));
}

/// The words at an axis of that length: the ends of the range, and the name in the middle of what they leave. `y`: of
/// their line.
std::string words_at(const AxisWords& words, double length, double y) {
  constexpr double letter = 6.5, gap = 3.0;  // of the page's letters, at most in the mean of a word [px]
  const double begin = letter * static_cast<double>(words.low.size()) + gap,
               end = length - letter * static_cast<double>(words.high.size()) - gap;
  const auto most = static_cast<std::size_t>((end - begin) / letter);
  const std::string name = words.name.size() <= most ? words.name : shortened(words.name, most - 2);  // dots are narrow
  return axis_text(0.0, y, "start", words.low) + axis_text(0.5 * (begin + end), y, "middle", name) +
         axis_text(length, y, "end", words.high);
}

/// The frame, its content, and the words at the axis across and at the one up.
std::string svg(const std::string& label, const std::string& content, const AxisWords& across, const AxisWords& up) {
  const char* const role = content.find("<a href") == std::string::npos ? "img" : "group";  // an image has no links
  return fmt::format(
      "<svg viewBox=\"-18 -8 {:g} {:g}\" width=\"{:g}\" role=\"{}\" aria-label=\"{}\"><rect class=\"frame\" "
      "width=\"{:g}\" height=\"{:g}\"/>{}{}<g transform=\"translate(0 {:g}) rotate(-90)\">{}</g></svg>",
      width + 26.0, height + 26.0, width + 26.0, role, html_text(label), width, height, content,
      words_at(across, width, height + 13.0), height, words_at(up, height, -4.0));
}

AxisWords words_of(const CaseTable& table, std::size_t parameter, const std::string& name) {
  if (!table.words[parameter].empty()) return {name};
  const Axis axis = Axis::of_parameter(table, parameter);
  return {name, short_number(axis.low()), short_number(axis.high())};
}

std::string ends_of(const CaseTable& table, std::size_t parameter) {
  const std::vector<std::string>& words = table.words[parameter];
  if (words.size() > most_labels) return fmt::format("{} words", words.size());
  if (!words.empty()) return fmt::format("{}", fmt::join(words, ", "));
  const Axis axis = Axis::of_parameter(table, parameter);
  return fmt::format("{} to {}", short_number(axis.low()), short_number(axis.high()));
}

/// The distributions of passed and failed cases over a column, each as shares of its own number.
std::string histogram(const CaseTable& table, const std::vector<double>& column, const Axis& axis,
                      const std::string& label) {
  std::vector<double> counts[2] = {std::vector<double>(bins), std::vector<double>(bins)};
  double sums[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i) || !std::isfinite(column[i])) continue;
    const auto bin = static_cast<std::size_t>(axis.share(column[i]) * static_cast<double>(bins));
    const std::size_t kind = table.passed(i) ? 0 : 1;
    ++counts[kind][std::min(bin, bins - 1)];
    ++sums[kind];
  }
  double largest = 1e-12;
  for (std::size_t kind = 0; kind < 2; ++kind)
    for (double& count : counts[kind]) largest = std::max(largest, count /= std::max(sums[kind], 1.0));
  std::string bars;
  constexpr double bar = width / static_cast<double>(bins);
  for (std::size_t kind = 0; kind < 2; ++kind)
    for (std::size_t i = 0; i < bins; ++i) {
      const double size = height * counts[kind][i] / largest;
      if (size > 0.0)
        bars += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                            kind == 0 ? "passed" : "failed", bar * static_cast<double>(i), height - size, bar, size);
    }
  return svg(label, bars, {label, short_number(axis.low()), short_number(axis.high())},
             {"share of cases", "0", fmt::format("{:.3g} %", 100.0 * largest)});
}

std::string label_at(double x, double y, const std::string& word) {
  return fmt::format("<text class=\"word\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y, html_text(shortened(word, 12)));
}

/// A bar for each word: the share that passes below, the share that fails above.
std::string word_bars(const CaseTable& table, std::size_t parameter, const std::string& label) {
  const std::vector<std::string>& words = table.words[parameter];
  std::vector<double> passed(words.size()), all(words.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i)) continue;
    const auto word = static_cast<std::size_t>(table.values[parameter][i]);
    ++all[word];
    passed[word] += table.passed(i) ? 1.0 : 0.0;
  }
  const double slot = width / static_cast<double>(words.size());
  std::string bars;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const double left = slot * static_cast<double>(i), size = all[i] > 0.0 ? height * passed[i] / all[i] : 0.0;
    const auto bar = [&](const char* kind, double top, double tall) {
      if (all[i] > 0.0 && tall > 0.0)
        bars += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", kind,
                            left + 0.1 * slot, top, 0.8 * slot, tall);
    };
    bar("failed", 0.0, height - size);
    bar("passed", height - size, size);
    if (words.size() <= most_labels) bars += label_at(left + 0.1 * slot + 2.0, height - 4.0, words[i]);
  }
  return svg(label, bars, {label}, {"passing share", "0", "100 %"});
}

/// The words of a parameter at their places on an axis; empty: it has numbers, or too many words.
std::string axis_labels(const CaseTable& table, std::size_t parameter, bool across) {
  const std::vector<std::string>& words = table.words[parameter];
  if (words.size() > most_labels) return "";
  const Axis axis = Axis::of_parameter(table, parameter);
  std::string labels;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const double share = axis.share(static_cast<double>(i));
    labels += across ? label_at(0.85 * width * share, height - 4.0, words[i])
                     : label_at(2.0, 10.0 + (height - 24.0) * (1.0 - share), words[i]);
  }
  return labels;
}

/// Failed cases are drawn above passed ones; of many of a kind only some.
std::string scatter(const CaseTable& table, std::size_t a, std::size_t b, const AxisWords& across,
                    const AxisWords& up) {
  const Axis x = Axis::of_parameter(table, a), y = Axis::of_parameter(table, b);
  std::string points;
  for (const bool passed : {true, false})
    for (const std::size_t i : drawn_cases(table, passed))
      points += dot_of(table, i, width * x.share(table.values[a][i]), height * (1.0 - y.share(table.values[b][i])));
  return svg(across.name + ", " + up.name, points + axis_labels(table, a, true) + axis_labels(table, b, false), across,
             up);
}

std::string figure(const std::string& picture, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", picture, html_text(caption));
}

/// The parameters with the largest effect on passing or on a margin come first.
std::vector<std::size_t> by_effect(const CampaignFindings& findings) {
  std::vector<std::size_t> order(findings.parameters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t i) { return findings.parameters[i].largest_effect(); });
  return order;
}

}  // namespace

std::string pictures_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings) {
  const std::vector<Variation>& variations = campaign.scenario().variations;
  const std::vector<std::size_t> order = by_effect(findings);
  std::string text =
      "<section class=\"panel\" aria-label=\"Passed and failed\"><h2>Passed and failed</h2>\n<p>Each distribution in "
      "shares of its own cases: <b class=\"passed\">passed</b>, "
      "<b class=\"failed\">failed</b>. A bar of a word is the share of its cases.</p>\n<div class=\"pictures\">\n";
  for (const std::size_t i : order)
    text += figure(table.words[i].empty()
                       ? histogram(table, table.values[i], Axis::of_parameter(table, i), variations[i].name)
                       : word_bars(table, i, variations[i].name),
                   fmt::format("{}: {}", variations[i].name, ends_of(table, i)));
  for (std::size_t e = 0; e < table.margins.size(); ++e) {
    const auto is_number = [](double margin) { return std::isfinite(margin); };
    if (std::ranges::none_of(table.margins[e], is_number)) continue;  // the margin of an event
    const Axis axis(table.margins[e]);
    const std::string& expectation = campaign.expectations()[e];
    text +=
        figure(histogram(table, table.margins[e], axis, "margin of " + expectation),
               fmt::format("margin of {}: {} to {}", expectation, short_number(axis.low()), short_number(axis.high())));
  }
  text +=
      "</div></section>\n<section class=\"panel\" aria-label=\"Pairs of parameters\"><h2>Pairs of "
      "parameters</h2>\n<p>A dot leads to its case, which is shown below.</p>\n"
      "<div class=\"pictures\">\n";
  std::size_t drawn = 0;
  for (std::size_t b = 1; b < order.size(); ++b)
    for (std::size_t a = 0; a < b && drawn < most_pairs; ++a, ++drawn)
      text += figure(scatter(table, order[a], order[b], words_of(table, order[a], variations[order[a]].name),
                             words_of(table, order[b], variations[order[b]].name)),
                     fmt::format("across {}, {}; up {}, {}", variations[order[a]].name, ends_of(table, order[a]),
                                 variations[order[b]].name, ends_of(table, order[b])));
  text += "</div>\n";
  if (drawn > 0) text += case_articles(campaign, table);
  return text + "</section>\n";
}

}  // namespace rehearse
