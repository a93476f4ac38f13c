#include "campaign_findings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "axis.h"
#include "campaigns/plan/result_lines.h"
#include "importance.h"

namespace rehearse {
namespace {

constexpr std::size_t listed_cases = 5, listed_passes = 3;

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return quantile_of_sorted(values, 0.5);
}

std::vector<std::int64_t> first_cases(std::vector<std::int64_t> cases) {
  cases.resize(std::min(cases.size(), listed_cases));
  return cases;
}

std::vector<ErrorKind> errors_of(const CaseTable& table) {
  std::map<std::string, ErrorKind> kinds;
  for (const auto& [number, text] : table.first_errors) {
    ErrorKind& kind = kinds[without_numbers(text)];
    if (kind.count++ == 0) kind.example = text;
    kind.passed += table.passed(static_cast<std::size_t>(number)) ? 1 : 0;
    if (kind.cases.size() < listed_cases) kind.cases.push_back(number);
  }
  std::vector<ErrorKind> errors;
  for (auto& [text, kind] : kinds) {
    kind.error = text;
    errors.push_back(std::move(kind));
  }
  std::ranges::stable_sort(errors, [](const ErrorKind& a, const ErrorKind& b) { return a.count > b.count; });
  return errors;
}

/// The rank correlation with a column, over the cases that have both.
double correlation(const CaseTable& table, const std::vector<double>& values, const std::vector<double>& column) {
  std::vector<double> a, b;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i) || std::isnan(column[i])) continue;
    a.push_back(values[i]);
    b.push_back(column[i]);
  }
  return rank_correlation(a, b);
}

/// The expectation on whose margin a parameter has the largest effect.
std::optional<OfMargin> strongest_margin(const Campaign& campaign, const CaseTable& table,
                                         const std::vector<double>& values) {
  std::optional<OfMargin> strongest;
  for (std::size_t e = 0; e < table.margins.size(); ++e) {
    const double found = correlation(table, values, table.margins[e]);
    if (std::abs(found) > (strongest ? std::abs(strongest->number) : 0.0))
      strongest = OfMargin{campaign.expectations()[e], found};
  }
  return strongest;
}

/// Words have no order, so no rank: of each the share that passes, and their association with passing.
void add_words(const CaseTable& table, std::size_t index, ParameterFindings& parameter) {
  const std::vector<std::string>& words = table.words[index];
  std::vector<std::vector<std::int64_t>> counts(words.size(), {0, 0});  // by word: passed and failed cases
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i)) ++counts[static_cast<std::size_t>(table.values[index][i])][table.passed(i) ? 0 : 1];
  parameter.has_words = true;
  parameter.association_with_passing = if_finite(cramers_v(counts));
  for (std::size_t word = 0; word < words.size(); ++word) {
    const std::int64_t passed = counts[word][0], all = passed + counts[word][1];
    const auto share = all == 0 ? std::nullopt : std::optional(static_cast<double>(passed) / static_cast<double>(all));
    parameter.words.push_back({words[word], all, passed, share, exact_interval(passed, all)});
  }
}

ParameterFindings findings_on_parameter(const Campaign& campaign, const CaseTable& table, std::size_t index) {
  const Variation& variation = campaign.scenario().variations[index];
  const std::vector<double>& values = table.values[index];
  ParameterFindings found{.name = variation.name, .path = variation.path, .nominal = variation.nominal};
  found.importance_of_passing = importance_of_passing(table, index);
  found.importance_of_margin = importance_of_margin(campaign, table, index);
  if (!table.words[index].empty()) {
    add_words(table, index, found);
    return found;
  }
  std::vector<double> passing(table.size(), std::numeric_limits<double>::quiet_NaN()), of_passed, of_failed;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i)) continue;
    passing[i] = table.passed(i) ? 1.0 : 0.0;
    (table.passed(i) ? of_passed : of_failed).push_back(values[i]);
  }
  found.correlation_with_passing = if_finite(correlation(table, values, passing));
  found.correlation_with_margin = strongest_margin(campaign, table, values);
  found.median_of_passed = if_finite(median(of_passed));
  found.median_of_failed = if_finite(median(of_failed));
  return found;
}

MarginFindings findings_on_margins(const Campaign& campaign, const CaseTable& table, std::size_t expectation) {
  std::vector<double> margins;
  std::vector<std::pair<double, std::int64_t>> passes;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double margin = table.margins[expectation][i];
    if (std::isnan(margin)) continue;
    margins.push_back(margin);
    if (table.passed(i)) passes.emplace_back(margin, static_cast<std::int64_t>(i));
  }
  std::ranges::sort(margins);
  std::ranges::sort(passes);
  const auto quantile = [&](double share) { return if_finite(quantile_of_sorted(margins, share)); };
  MarginFindings found{
      campaign.expectations()[expectation], quantile(0.0), quantile(0.05), quantile(0.5), quantile(1.0), {}};
  for (std::size_t i = 0; i < std::min(passes.size(), listed_passes); ++i)
    found.worst_passes.emplace_back(passes[i].second, passes[i].first);
  return found;
}

UnvisitedCells unvisited_cells(const Campaign& campaign, const CaseTable& table, std::size_t a, std::size_t b) {
  const CellGrid grid(table, a, b);
  const std::vector<Variation>& variations = campaign.scenario().variations;
  UnvisitedCells found{{variations[a].name, variations[b].name}, grid.counts.size(), 0, {}};
  for (std::size_t row = 0; row < grid.rows; ++row)
    for (std::size_t column = 0; column < grid.columns; ++column) {
      if (grid.counts[row * grid.columns + column] > 0) continue;
      if (found.unvisited++ < listed_cases)
        found.examples.push_back({cell_text(table, a, column), cell_text(table, b, row)});
    }
  return found;
}

}  // namespace

std::vector<FailureKind> failures_of(const CaseTable& table) {
  std::vector<std::vector<std::int64_t>> cases(table.reason_texts.size());
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i) && !table.passed(i)) cases[table.reasons[i]].push_back(static_cast<std::int64_t>(i));
  std::vector<std::size_t> order(cases.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t reason) { return cases[reason].empty(); });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return cases[a].size() != cases[b].size() ? cases[a].size() > cases[b].size() : cases[a][0] < cases[b][0];
  });
  std::vector<FailureKind> failures;
  for (const std::size_t reason : order)
    failures.push_back({table.reason_texts[reason], *table.verdicts[static_cast<std::size_t>(cases[reason][0])],
                        cases[reason].size(), table.reason_examples[reason], first_cases(cases[reason])});
  return failures;
}

double ParameterFindings::largest_effect() const {
  const auto& passing = has_words ? association_with_passing : correlation_with_passing;
  return std::max(std::abs(passing.value_or(0.0)),
                  correlation_with_margin ? std::abs(correlation_with_margin->number) : 0.0);
}

CampaignFindings CampaignFindings::of(const Campaign& campaign, const CaseTable& table, CampaignSummary summary) {
  CampaignFindings found{.scenario = campaign.scenario().name,
                         .seed = campaign.options().seed,
                         .plan = campaign.digest(),
                         .summary = std::move(summary),
                         .nominal = campaign.nominal(),
                         .failures = failures_of(table),
                         .errors = errors_of(table)};
  const std::size_t count = campaign.scenario().variations.size();
  for (std::size_t i = 0; i < count; ++i) found.parameters.push_back(findings_on_parameter(campaign, table, i));
  for (std::size_t i = 0; i < table.margins.size(); ++i)
    found.margins.push_back(findings_on_margins(campaign, table, i));
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) found.cells.push_back(unvisited_cells(campaign, table, a, b));
  return found;
}

}  // namespace rehearse
