#include "campaign_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <concepts>
#include <optional>

#include "axis.h"
#include "base/text.h"
#include "campaign_pictures.h"
#include "viewing/report/html_text.h"
#include "viewing/report/small_page.h"

namespace rehearse {
namespace {

constexpr std::string_view failures_title = "Failures";
constexpr std::size_t most_words = 20;  // of a parameter, in the table

std::string percent(double share) { return fmt::format("{:.4g} %", 100.0 * share); }

std::string range_text(const Interval& interval) {
  return fmt::format("{} to {}", percent(interval.low), percent(interval.high));
}

std::string text_of(double value) { return short_number(value); }
std::string text_of(const FirstOrderIndex& index) {
  return fmt::format("{:.3g} % ({:.3g} to {:.3g} %)", 100.0 * index.share, 100.0 * index.interval.low,
                     100.0 * index.interval.high);
}
template <std::integral T>
std::string text_of(T value) {
  return std::to_string(value);
}
template <class T>
std::string text_of(const std::optional<T>& value) {
  return value ? text_of(*value) : "-";
}

std::string percent_or_dash(const std::optional<double>& share) { return share ? percent(*share) : "-"; }

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
  const auto add = [&table](std::string_view name, std::int64_t count) {
    if (count > 0) table.rows.push_back({std::string(name), text_of(count)});
  };
  for (std::size_t i = 0; i < case_verdict_count; ++i)
    add(to_string(static_cast<CaseVerdict>(i)), findings.summary.verdicts[i]);
  add("missing", findings.summary.missing);
  return table;
}

ReportTable failure_table(const CampaignFindings& findings) {
  ReportTable table{std::string(failures_title), "", {"cases", "verdict", "failure", "for example", "first cases"}, {}};
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
      "first-order index), with its interval of 95 % confidence. What the intervals leave to 100 % comes from "
      "parameters together.",
      {"parameter", "of passing", "of a margin"},
      {}};
  for (const ParameterFindings& parameter : findings.parameters) {
    const auto& margin = parameter.importance_of_margin;
    if (!parameter.importance_of_passing && !margin) continue;
    table.rows.push_back({parameter.name, text_of(parameter.importance_of_passing),
                          margin ? fmt::format("{}: {}", text_of(margin->index), margin->expectation) : "-"});
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
                    "Pairs of parameters in four by four equal parts of their ranges, of log_uniform in equal ratios.",
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
  std::vector<ReportTable> tables;
  if (ReportTable failures = failure_table(findings); !failures.rows.empty()) tables.push_back(std::move(failures));
  tables.push_back(verdict_table(findings));
  if (findings.against) {
    tables.push_back(change_table(*findings.against));
    tables.push_back(difference_table(*findings.against));
  }
  for (auto* make : {fault_table, error_table, parameter_table, importance_table, word_table, margin_table, cell_table})
    if (ReportTable table = make(findings); !table.rows.empty()) tables.push_back(std::move(table));
  return tables;
}

std::string subtitle_of(const CampaignFindings& findings) {
  const CampaignSummary& summary = findings.summary;
  std::string text = fmt::format("Scenario {}, seed {}, plan {}. ", findings.scenario, findings.seed, findings.plan);
  text += fmt::format(
      "The share that passes is within {} with {} confidence ({}). ", range_text(summary.interval()),
      percent(summary.confidence()),
      summary.until_failures == 0 ? "the exact interval" : "of inverse sampling: the work ended with a failure");
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

}  // namespace

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
  std::string sentence;
  if (!findings.failures.empty()) {
    const FailureKind& first = findings.failures[0];
    sentence = fmt::format("{} {} in {}: {}", findings.failures.size() > 1 ? "Most often" : "Always",
                           to_string(first.verdict), count_text(first.count, "case"), first.reason);
  }
  std::string content = fmt::format("<section class=\"panel\" aria-label=\"campaign\"><p>{}</p></section>\n",
                                    html_text(subtitle_of(findings)));
  bool has_pictures = false;
  for (const ReportTable& part : tables_of(findings)) {
    if (part.title == "Parameters" && !has_pictures) {
      content += pictures_of(campaign, table, findings);
      has_pictures = true;
    }
    const std::string title = html_text(part.title);
    content += fmt::format("<section class=\"panel\" aria-label=\"{0}\"{1}><h2>{0}</h2>\n", title,
                           part.title == failures_title ? " data-finding" : "");
    if (!part.remark.empty()) content += fmt::format("<p>{}</p>\n", html_text(part.remark));
    content += fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"table: {}\"><table>\n<thead>", title);
    content += html_row(part.heading, "th") + "</thead><tbody>\n";
    for (const Row& row : part.rows) content += html_row(row, "td");
    content += "</tbody></table></div></section>\n";
  }
  return small_page({.magic = "<!doctype html>",
                     .kind = "Campaign",
                     .is_bad = !findings.failures.empty(),
                     .title = verdict(findings.summary),
                     .sentence = sentence,
                     .content = content});
}

}  // namespace rehearse
