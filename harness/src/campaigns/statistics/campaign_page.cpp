#include "campaign_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <functional>
#include <numeric>
#include <optional>

#include "case_articles.h"
#include "viewing/report/html_text.h"

namespace rehearse {
namespace {

constexpr std::size_t parts = 4;  // of a range, in cells
constexpr std::size_t bins = 20;  // of a histogram
constexpr std::size_t most_pairs = 6;
constexpr std::size_t most_labels = 8;           // words at an axis
constexpr std::size_t most_words = 20;           // of a parameter, in the table
constexpr double width = 260.0, height = 150.0;  // of a picture [px]

struct Extent {
  double low = 0.0, high = 1.0;
  double share(double value) const { return high > low ? (value - low) / (high - low) : 0.5; }
};

Extent extent_of(const std::vector<double>& values) {
  Extent extent;
  bool any = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    extent.low = any ? std::min(extent.low, value) : value;
    extent.high = any ? std::max(extent.high, value) : value;
    any = true;
  }
  return extent;
}

std::size_t cells_of_parameter(const CaseTable& table, std::size_t parameter) {
  return table.words[parameter].empty() ? parts : table.words[parameter].size();
}

std::size_t cell_of(const CaseTable& table, std::size_t parameter, const Extent& extent, double value) {
  if (!table.words[parameter].empty()) return static_cast<std::size_t>(value);
  return std::min(parts - 1, static_cast<std::size_t>(extent.share(value) * static_cast<double>(parts)));
}

std::string short_number(double value) { return fmt::format("{:.4g}", value); }

std::string percent(double share) { return fmt::format("{:.4g} %", 100.0 * share); }

std::string text_of(double value) { return short_number(value); }
template <std::integral T>
std::string text_of(T value) {
  return std::to_string(value);
}
template <class T>
std::string text_of(const std::optional<T>& value) {
  return value ? text_of(*value) : "-";
}

std::string percent_or_dash(const std::optional<double>& share) { return share ? percent(*share) : "-"; }

std::string range_text(const Interval& interval) {
  return fmt::format("{} to {}", percent(interval.low), percent(interval.high));
}

std::string case_list(const std::vector<std::int64_t>& cases) { return fmt::format("{}", fmt::join(cases, ", ")); }

using Row = std::vector<std::string>;

/// A table of the report, for both forms.
struct ReportTable {
  std::string title, remark;
  Row heading;
  std::vector<Row> rows;
};

ReportTable verdict_table(const CampaignFindings& findings) {
  ReportTable table{"Verdicts", "", {"verdict", "cases"}, {}};
  for (std::size_t i = 0; i < case_verdict_count; ++i)
    table.rows.push_back({std::string(to_string(static_cast<CaseVerdict>(i))), text_of(findings.summary.verdicts[i])});
  table.rows.push_back({"missing", text_of(findings.summary.missing)});
  return table;
}

ReportTable failure_table(const CampaignFindings& findings) {
  ReportTable table{"Failures", "", {"cases", "verdict", "failure", "for example", "first cases"}, {}};
  for (const FailureKind& failure : findings.failures)
    table.rows.push_back({text_of(failure.count), std::string(to_string(failure.verdict)), failure.reason,
                          failure.sentence, case_list(failure.cases)});
  return table;
}

ReportTable error_table(const CampaignFindings& findings) {
  ReportTable table{
      "Errors of controllers",
      "Cases in which a controller wrote a number that isn't finite, or a line that begins with \"error\". "
      "The verdict doesn't depend on them.",
      {"cases", "of which pass", "error", "for example", "first cases"},
      {}};
  for (const ErrorKind& error : findings.errors)
    table.rows.push_back(
        {text_of(error.count), text_of(error.passed), error.error, error.example, case_list(error.cases)});
  return table;
}

ReportTable parameter_table(const CampaignFindings& findings) {
  ReportTable table{
      "Parameters",
      "Rank correlation (Spearman) of each parameter with passing, and with the margin on which it has "
      "the largest effect. Words have no order: V is Cramér's association with passing, 0 to 1.",
      {"parameter", "path", "nominal", "with passing", "with a margin", "median of passed", "median of failed"},
      {}};
  for (const ParameterFindings& parameter : findings.parameters) {
    const auto& margin = parameter.correlation_with_margin;
    table.rows.push_back({parameter.name, parameter.path, parameter.nominal,
                          parameter.has_words ? "V " + text_of(parameter.association_with_passing)
                                              : text_of(parameter.correlation_with_passing),
                          margin ? fmt::format("{}: {}", text_of(margin->number), margin->expectation) : "-",
                          text_of(parameter.median_of_passed), text_of(parameter.median_of_failed)});
  }
  return table;
}

ReportTable importance_table(const CampaignFindings& findings) {
  ReportTable table{
      "Importance",
      "The share of the variance of passing, and of a margin, that each parameter explains alone (Sobol's "
      "first-order index). What is missing to 100 % comes from parameters together.",
      {"parameter", "of passing", "of a margin"},
      {}};
  for (const ParameterFindings& parameter : findings.parameters) {
    const auto& margin = parameter.importance_of_margin;
    if (!parameter.importance_of_passing && !margin) continue;
    table.rows.push_back({parameter.name, percent_or_dash(parameter.importance_of_passing),
                          margin ? fmt::format("{}: {}", percent(margin->number), margin->expectation) : "-"});
  }
  return table;
}

ReportTable word_table(const CampaignFindings& findings) {
  ReportTable table{"Words",
                    "The share of the cases with each word that passes, with its interval.",
                    {"parameter", "word", "cases", "passed", "share", "95 % confidence"},
                    {}};
  for (const ParameterFindings& parameter : findings.parameters) {
    if (!parameter.has_words) continue;
    const std::vector<WordShare>& words = parameter.words;
    for (std::size_t i = 0; i < std::min(words.size(), most_words); ++i)
      table.rows.push_back({parameter.name, words[i].word, text_of(words[i].cases), text_of(words[i].passed),
                            percent_or_dash(words[i].share), range_text(words[i].interval)});
    if (words.size() > most_words)
      table.rows.push_back({parameter.name, fmt::format("and {} more", words.size() - most_words)});
    table.rows.back().resize(table.heading.size());
  }
  return table;
}

ReportTable margin_table(const CampaignFindings& findings) {
  ReportTable table{"Margins",
                    "Distance of each expectation from a violation, in its unit; below 0 it is violated. The worst "
                    "passes are the passing cases that were nearest to it.",
                    {"expectation", "least", "5 %", "median", "largest", "worst passes"},
                    {}};
  for (const MarginFindings& margin : findings.margins) {
    std::string worst;
    for (const auto& [number, distance] : margin.worst_passes)
      worst += fmt::format("{}case {} ({})", worst.empty() ? "" : ", ", number, text_of(distance));
    table.rows.push_back({margin.expectation, text_of(margin.least), text_of(margin.percentile_5),
                          text_of(margin.median), text_of(margin.largest), worst});
  }
  return table;
}

ReportTable fault_table(const CampaignFindings& findings) {
  ReportTable table{"Faults and expectations",
                    "In how many cases with each fault an expectation holds, and with which values it is violated. "
                    "Cases that end before their expectations are judged count as not judged.",
                    {"fault", "cases"},
                    {}};
  const std::vector<FaultRow>& faults = findings.summary.faults;
  for (const FaultRow& fault : faults) {
    Row row{to_string(fault.fault), text_of(fault.cases)};
    for (const FaultCell& cell : fault.cells) row.push_back(to_string(cell));
    table.rows.push_back(std::move(row));
  }
  if (faults.empty()) return table;
  for (const FaultCell& cell : faults[0].cells) table.heading.push_back(cell.expectation);
  return table;
}

ReportTable cell_table(const CampaignFindings& findings) {
  ReportTable table{"Cells that no case visited",
                    "Pairs of parameters in four by four equal parts of their ranges.",
                    {"parameters", "unvisited", "of", "for example"},
                    {}};
  for (const UnvisitedCells& cells : findings.cells) {
    if (cells.unvisited == 0) continue;
    std::string examples;
    for (const auto& [a, b] : cells.examples) examples += fmt::format("{}({}; {})", examples.empty() ? "" : ", ", a, b);
    table.rows.push_back({fmt::format("{}, {}", cells.parameters[0], cells.parameters[1]), text_of(cells.unvisited),
                          text_of(cells.cells), examples});
  }
  return table;
}

ReportTable change_table(const CampaignChange& change) {
  ReportTable table{"Before and after",
                    "The same cases in another campaign. p: the probability of flips as unequal as these, if both "
                    "directions were as likely (McNemar's exact test). The interval of the difference is Tango's.",
                    {"", "cases", "first cases, or interval"},
                    {}};
  table.rows.push_back({"compared", text_of(change.pairs.all), ""});
  table.rows.push_back({"with the same bits", text_of(change.same_bits), ""});
  table.rows.push_back({"passed before, fail now", text_of(change.pairs.broken), case_list(change.broken_cases)});
  table.rows.push_back({"failed before, pass now", text_of(change.pairs.mended), case_list(change.mended_cases)});
  table.rows.push_back({"p", text_of(change.p), ""});
  if (change.difference)
    table.rows.push_back(
        {"difference of the shares that pass", percent(*change.difference), range_text(change.interval)});
  return table;
}

ReportTable difference_table(const CampaignChange& change) {
  ReportTable table{"What differs between the two campaigns", "Flips may come from any of these.", {"difference"}, {}};
  for (const std::string& difference : change.differences) table.rows.push_back({difference});
  if (table.rows.empty()) table.rows.push_back({"neither the scenario, nor a controller, a model or an option"});
  return table;
}

std::vector<ReportTable> tables_of(const CampaignFindings& findings) {
  std::vector<ReportTable> tables{verdict_table(findings)};
  if (findings.against) {
    tables.push_back(change_table(*findings.against));
    tables.push_back(difference_table(*findings.against));
  }
  for (auto* make : {failure_table, fault_table, error_table, parameter_table, importance_table, word_table,
                     margin_table, cell_table})
    if (ReportTable table = make(findings); !table.rows.empty()) tables.push_back(std::move(table));
  return tables;
}

std::string subtitle_of(const CampaignFindings& findings) {
  const CampaignSummary& summary = findings.summary;
  std::string text = fmt::format("Scenario {}, seed {}, plan {}. ", findings.scenario, findings.seed, findings.plan);
  text += fmt::format(
      "The share that passes is within {} with {} confidence ({}). ", range_text(summary.interval()),
      percent(summary.confidence()),
      summary.until_failures == 0 ? "Wilson's interval" : "of inverse sampling: the work ended with a failure");
  text += fmt::format("The nominal scenario: {}. ", to_string(findings.nominal.verdict));
  return text + fmt::format("Cases that ran twice, in different processes: {}; {}.", summary.repeated,
                            summary.unrepeated.empty() ? "each gave the same bits"
                                                       : "these differed: " + case_list(summary.unrepeated));
}

std::string md_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::string html_row(const Row& row, const char* cell) {
  std::string text = "<tr>";
  for (const std::string& content : row) text += fmt::format("<{0}>{1}</{0}>", cell, html_text(content));
  return text + "</tr>\n";
}

std::string svg(const std::string& label, const std::string& content) {
  return fmt::format(
      "<svg viewBox=\"-8 -8 {:g} {:g}\" width=\"{:g}\" role=\"img\" aria-label=\"{}\"><rect class=\"frame\" "
      "width=\"{:g}\" height=\"{:g}\"/>{}</svg>",
      width + 16.0, height + 16.0, width + 16.0, html_text(label), width, height, content);
}

std::string ends_of(const CaseTable& table, std::size_t parameter) {
  const std::vector<std::string>& words = table.words[parameter];
  if (words.size() > most_labels) return fmt::format("{} words", words.size());
  if (!words.empty()) return fmt::format("{}", fmt::join(words, ", "));
  const Extent extent = extent_of(table.values[parameter]);
  return fmt::format("{} to {}", short_number(extent.low), short_number(extent.high));
}

/// The distributions of passed and failed cases over a column, each as shares of its own number.
std::string histogram(const CaseTable& table, const std::vector<double>& column, const std::string& label) {
  const Extent extent = extent_of(column);
  std::vector<double> counts[2] = {std::vector<double>(bins), std::vector<double>(bins)};
  double sums[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i) || !std::isfinite(column[i])) continue;
    const auto bin = static_cast<std::size_t>(extent.share(column[i]) * static_cast<double>(bins));
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
  return svg(label, bars);
}

std::string label_at(double x, double y, const std::string& word) {
  std::size_t end = std::min<std::size_t>(word.size(), 12);
  while (end < word.size() && (static_cast<unsigned char>(word[end]) & 0xC0) == 0x80) --end;  // within a letter
  const std::string shown = word.substr(0, end) + (end < word.size() ? "..." : "");
  return fmt::format("<text class=\"word\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y, html_text(shown));
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
  return svg(label, bars);
}

/// The words of a parameter at their places on an axis; empty: it has numbers, or too many words.
std::string axis_labels(const CaseTable& table, std::size_t parameter, bool across) {
  const std::vector<std::string>& words = table.words[parameter];
  if (words.size() > most_labels) return "";
  const Extent extent = extent_of(table.values[parameter]);
  std::string labels;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const double share = extent.share(static_cast<double>(i));
    labels += across ? label_at(0.85 * width * share, height - 4.0, words[i])
                     : label_at(2.0, 10.0 + (height - 24.0) * (1.0 - share), words[i]);
  }
  return labels;
}

/// Failed cases are drawn above passed ones; of many of a kind only some.
std::string scatter(const CaseTable& table, std::size_t a, std::size_t b, const std::string& label) {
  const Extent x = extent_of(table.values[a]), y = extent_of(table.values[b]);
  std::string points;
  for (const bool passed : {true, false})
    for (const std::size_t i : drawn_cases(table, passed))
      points += dot_of(table, i, width * x.share(table.values[a][i]), height * (1.0 - y.share(table.values[b][i])));
  return svg(label, points + axis_labels(table, a, true) + axis_labels(table, b, false));
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

std::string pictures_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings) {
  const std::vector<Variation>& variations = campaign.scenario().variations;
  const std::vector<std::size_t> order = by_effect(findings);
  std::string text =
      "<h2>Passed and failed</h2>\n<p>Each distribution in shares of its own cases: <b class=\"passed\">passed</b>, "
      "<b class=\"failed\">failed</b>. A bar of a word is the share of its cases.</p>\n<div class=\"pictures\">\n";
  for (const std::size_t i : order)
    text += figure(table.words[i].empty() ? histogram(table, table.values[i], variations[i].name)
                                          : word_bars(table, i, variations[i].name),
                   fmt::format("{}: {}", variations[i].name, ends_of(table, i)));
  for (std::size_t e = 0; e < table.margins.size(); ++e) {
    const auto is_number = [](double margin) { return std::isfinite(margin); };
    if (std::ranges::none_of(table.margins[e], is_number)) continue;  // the margin of an event
    const Extent extent = extent_of(table.margins[e]);
    const std::string& expectation = campaign.expectations()[e];
    text +=
        figure(histogram(table, table.margins[e], expectation),
               fmt::format("margin of {}: {} to {}", expectation, short_number(extent.low), short_number(extent.high)));
  }
  text +=
      "</div>\n<h2>Pairs of parameters</h2>\n<p>A dot leads to its case, which is shown below.</p>\n"
      "<div class=\"pictures\">\n";
  std::size_t drawn = 0;
  for (std::size_t b = 1; b < order.size(); ++b)
    for (std::size_t a = 0; a < b && drawn < most_pairs; ++a, ++drawn)
      text += figure(scatter(table, order[a], order[b], variations[order[a]].name + ", " + variations[order[b]].name),
                     fmt::format("across {}, {}; up {}, {}", variations[order[a]].name, ends_of(table, order[a]),
                                 variations[order[b]].name, ends_of(table, order[b])));
  text += "</div>\n";
  return drawn > 0 ? text + case_articles(campaign, table) : text;
}

}  // namespace

CellGrid::CellGrid(const CaseTable& table, std::size_t a, std::size_t b)
    : columns(cells_of_parameter(table, a)), rows(cells_of_parameter(table, b)), counts(columns * rows) {
  const Extent x = extent_of(table.values[a]), y = extent_of(table.values[b]);
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i))
      ++counts[cell_of(table, b, y, table.values[b][i]) * columns + cell_of(table, a, x, table.values[a][i])];
}

std::string cell_text(const CaseTable& table, std::size_t parameter, std::size_t cell) {
  if (!table.words[parameter].empty()) return table.words[parameter][cell];
  const Extent extent = extent_of(table.values[parameter]);
  const double part = (extent.high - extent.low) / static_cast<double>(parts);
  return fmt::format("{} to {}", short_number(extent.low + part * static_cast<double>(cell)),
                     short_number(extent.low + part * static_cast<double>(cell + 1)));
}

std::string markdown_of(const CampaignFindings& findings) {
  std::string text = fmt::format("# {}\n\n{}\n", verdict(findings.summary), subtitle_of(findings));
  for (const ReportTable& table : tables_of(findings)) {
    text += fmt::format("\n## {}\n\n", table.title);
    if (!table.remark.empty()) text += table.remark + "\n\n";
    const auto row_of = [](const Row& row) {
      std::string line = "|";
      for (const std::string& cell : row) line += ' ' + md_cell(cell) + " |";
      return line + '\n';
    };
    text += row_of(table.heading) + row_of(Row(table.heading.size(), "---"));
    for (const Row& row : table.rows) text += row_of(row);
  }
  return text;
}

std::string page_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings) {
  const std::string title = html_text(verdict(findings.summary));
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>\n{1}"
      "th {{ text-align: left; padding: .4rem .6rem; font-weight: 600 }}\n"
      ".scroll {{ overflow-x: auto }} .scroll td {{ overflow-wrap: break-word }}\n"
      ".pictures {{ display: flex; flex-wrap: wrap; gap: 1rem }}\n"
      "figure {{ margin: 0; width: 276px }} figcaption {{ font-size: .85rem; overflow-wrap: anywhere }}\n"
      ".frame {{ fill: none; stroke: #8888 }} .word {{ font-size: 11px; fill: currentColor }}\n"
      "b.passed {{ color: light-dark(#1b7a37, #7ddc97) }} b.failed {{ color: light-dark(#b3261e, #ff8a80) }}\n"
      "svg .passed {{ fill: light-dark(#1b7a37, #7ddc97); fill-opacity: .45 }}\n"
      ".case {{ display: none; overflow-wrap: anywhere }} .case:target {{ display: block }}\n"
      "svg .failed {{ fill: light-dark(#b3261e, #ff8a80); fill-opacity: .6 }}\n"
      "</style></head><body>\n<h1>{0}</h1>\n<p>{2}</p>\n",
      title, html_style, html_text(subtitle_of(findings)));
  bool has_pictures = false;
  for (const ReportTable& part : tables_of(findings)) {
    if (part.title == "Parameters" && !has_pictures) {
      text += pictures_of(campaign, table, findings);
      has_pictures = true;
    }
    text += fmt::format("<h2>{}</h2>\n", html_text(part.title));
    if (!part.remark.empty()) text += fmt::format("<p>{}</p>\n", html_text(part.remark));
    text += "<div class=\"scroll\"><table>\n" + html_row(part.heading, "th");
    for (const Row& row : part.rows) text += html_row(row, "td");
    text += "</table></div>\n";
  }
  return text + "</body></html>\n";
}

}  // namespace rehearse
