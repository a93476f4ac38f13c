// The results of a campaign: its summary, and the files of its report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "base/hashing.h"
#include "base/text.h"
#include "campaign_page.h"
#include "campaigns/plan/campaign_folder.h"
#include "campaigns/plan/csv_text.h"
#include "campaigns/plan/result_lines.h"
#include "case_table.h"
#include "comparison.h"
#include "core/golden/golden_files.h"
#include "core/scenario/campaign_claims.h"
#include "fault_matrix.h"
#include "importance.h"
#include "report_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t listed_cases = 5, listed_passes = 3, most_unrepeated = 100;

std::uint64_t hash_of_text(const std::string& text) {
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

std::optional<double> finite_number(const std::string& text) {
  const auto number = number_in<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// A parameter with a value that is no number has words; they are in the order of the alphabet.
void read_values(const Campaign& campaign, CaseTable& table) {
  const std::size_t count = campaign.scenario().variations.size();
  table.values.assign(count, std::vector<double>(table.size()));
  table.words.resize(count);
  std::vector<bool> has_words(count);
  for (std::size_t number = 0; number < table.size(); ++number) {
    const std::vector<std::string> values = campaign.values_of(static_cast<std::int64_t>(number));
    for (std::size_t i = 0; i < count; ++i)
      if (const auto value = finite_number(values[i]))
        table.values[i][number] = *value;
      else
        has_words[i] = true;
  }
  if (std::ranges::count(has_words, true) == 0) return;
  std::vector<std::map<std::string, std::vector<std::size_t>>> cases(count);  // by word
  for (std::size_t number = 0; number < table.size(); ++number) {
    std::vector<std::string> values = campaign.values_of(static_cast<std::int64_t>(number));
    for (std::size_t i = 0; i < count; ++i)
      if (has_words[i]) cases[i][std::move(values[i])].push_back(number);
  }
  for (std::size_t i = 0; i < count; ++i)
    for (const auto& [word, these] : cases[i]) {
      for (const std::size_t number : these) table.values[i][number] = static_cast<double>(table.words[i].size());
      table.words[i].push_back(word);
    }
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return quantile_of_sorted(values, 0.5);
}

/// The kinds of failures, the most frequent first.
Json failures_of(const CaseTable& table) {
  std::vector<std::vector<std::int64_t>> cases(table.reason_texts.size());
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i) && !table.passed(i)) cases[table.reasons[i]].push_back(static_cast<std::int64_t>(i));
  std::vector<std::size_t> order(cases.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t reason) { return cases[reason].empty(); });
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return cases[a].size() != cases[b].size() ? cases[a].size() > cases[b].size() : cases[a][0] < cases[b][0];
  });
  Json failures = Json::array();
  for (const std::size_t reason : order) {
    const std::vector<std::int64_t>& these = cases[reason];
    const auto listed = these.begin() + static_cast<std::ptrdiff_t>(std::min(these.size(), listed_cases));
    failures.push_back({{"reason", table.reason_texts[reason]},
                        {"verdict", std::string(to_string(*table.verdicts[static_cast<std::size_t>(these[0])]))},
                        {"count", these.size()},
                        {"sentence", table.reason_examples[reason]},
                        {"cases", std::vector<std::int64_t>(these.begin(), listed)}});
  }
  return failures;
}

/// The errors of controllers by kind, the most frequent first.
Json errors_of(const CaseTable& table) {
  struct Kind {
    std::vector<std::int64_t> cases;
    std::int64_t passed = 0;
  };
  std::map<std::string, Kind> kinds;
  for (const auto& [number, text] : table.first_errors) {
    Kind& kind = kinds[without_numbers(text)];
    kind.cases.push_back(number);
    kind.passed += table.passed(static_cast<std::size_t>(number)) ? 1 : 0;
  }
  std::vector<std::pair<std::string, Kind>> order(kinds.begin(), kinds.end());
  std::ranges::stable_sort(order,
                           [](const auto& a, const auto& b) { return a.second.cases.size() > b.second.cases.size(); });
  Json errors = Json::array();
  for (auto& [text, kind] : order) {
    const std::size_t count = kind.cases.size();
    const std::string& example = table.first_errors.at(kind.cases.front());
    kind.cases.resize(std::min(count, listed_cases));
    errors.push_back(
        {{"error", text}, {"count", count}, {"passed", kind.passed}, {"example", example}, {"cases", kind.cases}});
  }
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

/// The expectation on whose margin a parameter has the largest effect; null: no correlation is known.
Json strongest_margin(const Campaign& campaign, const CaseTable& table, const std::vector<double>& values) {
  double strongest = 0.0;
  std::string of_expectation;
  for (std::size_t e = 0; e < table.margins.size(); ++e) {
    const double found = correlation(table, values, table.margins[e]);
    if (!(std::abs(found) > std::abs(strongest))) continue;
    strongest = found;
    of_expectation = campaign.expectations()[e];
  }
  if (of_expectation.empty()) return nullptr;
  return {{"expectation", of_expectation}, {"correlation", strongest}};
}

/// Words have no order, so no rank: of each the share that passes, and their association with passing.
void add_words(const CaseTable& table, std::size_t index, Json& object) {
  const std::vector<std::string>& words = table.words[index];
  std::vector<std::vector<std::int64_t>> counts(words.size(), {0, 0});  // by word: passed and failed cases
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.has(i)) ++counts[static_cast<std::size_t>(table.values[index][i])][table.passed(i) ? 0 : 1];
  object["association_with_passing"] = number_or_null(cramers_v(counts));
  object["words"] = Json::array();
  for (std::size_t word = 0; word < words.size(); ++word) {
    const std::int64_t passed = counts[word][0], all = passed + counts[word][1];
    const double share = all == 0 ? none : static_cast<double>(passed) / static_cast<double>(all);
    object["words"].push_back({{"word", words[word]},
                               {"cases", all},
                               {"passed", passed},
                               {"share", number_or_null(share)},
                               {"interval", json_of_interval(wilson_interval(passed, all))}});
  }
}

Json json_of_parameter(const Campaign& campaign, const CaseTable& table, std::size_t index) {
  const Variation& variation = campaign.scenario().variations[index];
  const std::vector<double>& values = table.values[index];
  Json object{{"name", variation.name},
              {"path", variation.path},
              {"nominal", variation.nominal},
              {"correlation_with_passing", nullptr},
              {"correlation_with_margin", nullptr},
              {"importance", json_of_importance(campaign, table, index)},
              {"median_of_passed", nullptr},
              {"median_of_failed", nullptr}};
  if (!table.words[index].empty()) {
    add_words(table, index, object);
    return object;
  }
  std::vector<double> passing(table.size(), none), of_passed, of_failed;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (!table.has(i)) continue;
    passing[i] = table.passed(i) ? 1.0 : 0.0;
    (table.passed(i) ? of_passed : of_failed).push_back(values[i]);
  }
  object["correlation_with_passing"] = number_or_null(correlation(table, values, passing));
  object["correlation_with_margin"] = strongest_margin(campaign, table, values);
  object["median_of_passed"] = number_or_null(median(of_passed));
  object["median_of_failed"] = number_or_null(median(of_failed));
  return object;
}

Json json_of_margins(const Campaign& campaign, const CaseTable& table, std::size_t expectation) {
  std::vector<double> found;
  std::vector<std::pair<double, std::int64_t>> passes;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double margin = table.margins[expectation][i];
    if (std::isnan(margin)) continue;
    found.push_back(margin);
    if (table.passed(i)) passes.emplace_back(margin, static_cast<std::int64_t>(i));
  }
  std::ranges::sort(found);
  std::ranges::sort(passes);
  const auto quantile = [&](double share) { return number_or_null(quantile_of_sorted(found, share)); };
  Json worst = Json::array();
  for (std::size_t i = 0; i < std::min(passes.size(), listed_passes); ++i)
    worst.push_back({{"case", passes[i].second}, {"margin", passes[i].first}});
  return {{"expectation", campaign.expectations()[expectation]},
          {"least", quantile(0.0)},
          {"percentile_5", quantile(0.05)},
          {"median", quantile(0.5)},
          {"largest", quantile(1.0)},
          {"worst_passes", worst}};
}

/// The cells of a pair of parameters, 4 by 4 in equal parts of the ranges that occur, which no case with a result
/// visited.
Json cells_of(const Campaign& campaign, const CaseTable& table, std::size_t a, std::size_t b) {
  const CellGrid grid(table, a, b);
  Json unvisited = Json::array();
  for (std::size_t row = 0; row < grid.rows; ++row)
    for (std::size_t column = 0; column < grid.columns; ++column)
      if (grid.counts[row * grid.columns + column] == 0 && unvisited.size() < listed_cases)
        unvisited.push_back({cell_text(table, a, column), cell_text(table, b, row)});
  const auto empty = std::ranges::count(grid.counts, std::size_t{0});
  return {{"parameters", {campaign.scenario().variations[a].name, campaign.scenario().variations[b].name}},
          {"cells", grid.counts.size()},
          {"unvisited", empty},
          {"examples", unvisited}};
}

Json json_of_claim(const CampaignSummary& summary) {
  if (!summary.claim) return nullptr;
  const auto more = summary.more_cases();
  return {{"at_least", summary.claim->at_least},
          {"confidence", summary.claim->confidence},
          {"answer", std::string(to_string(summary.rate_answer()))},
          {"more_cases", more ? Json(*more) : Json(nullptr)}};
}

Json json_of_summary(const CampaignSummary& summary) {
  Json verdicts = Json::object();
  for (std::size_t i = 0; i < case_verdict_count; ++i)
    verdicts[std::string(to_string(static_cast<CaseVerdict>(i)))] = summary.verdicts[i];
  Json reached = Json::object();
  for (const auto& [name, count] : summary.reached) reached[name] = count;
  return {{"verdict", verdict(summary)},
          {"claim", json_of_claim(summary)},
          {"non_inferiority", json_of_non_inferiority(summary)},
          {"reached", reached},
          {"cases", summary.cases},
          {"verdicts", verdicts},
          {"missing", summary.missing},
          {"share", number_or_null(summary.share())},
          {"interval", json_of_interval(summary.interval())},
          {"until_failures", summary.until_failures > 0 ? Json(summary.until_failures) : Json(nullptr)},
          {"with_errors", summary.with_errors},
          {"passed_with_errors", summary.passed_with_errors},
          {"faults", json_of_faults(summary.faults)},
          {"repeated", summary.repeated},
          {"unrepeated", summary.unrepeated}};
}

CampaignSummary summary_of(const Campaign& campaign, const CaseTable& table) {
  CampaignSummary summary;
  summary.cases = static_cast<std::int64_t>(table.size());
  for (const auto& verdict : table.verdicts) {
    if (verdict)
      ++summary.verdicts[static_cast<std::size_t>(*verdict)];
    else
      ++summary.missing;
  }
  const CampaignClaims claims = claims_of(campaign.scenario());
  if (claims.pass_rate) summary.claim = ClaimedRate{claims.pass_rate->at_least, claims.pass_rate->confidence};
  for (std::size_t i = 0; i < claims.sometimes.size(); ++i)
    summary.reached.emplace_back(claims.sometimes[i].name, i < table.reached.size() ? table.reached[i] : 0);
  summary.repeated = table.repeated;
  summary.unrepeated = table.unrepeated;
  for (const auto& [number, text] : table.first_errors) {
    ++summary.with_errors;
    if (table.passed(static_cast<std::size_t>(number))) ++summary.passed_with_errors;
  }
  summary.faults = fault_matrix(campaign, table);
  const std::int64_t failures = ending_failures(campaign.folder());
  if (summary.missing > 0 && summary.failed() == failures) summary.until_failures = failures;
  return summary;
}

Result<void> write_csv(const Campaign& campaign, const CaseTable& table) {
  const fs::path file = campaign.folder() / "results.csv", draft = file.string() + ".part";
  std::ofstream stream(draft, std::ios::binary);
  std::string line = "case";
  for (const Variation& variation : campaign.scenario().variations) line += ',' + variation.name;
  line += ",verdict,tick,ticks,hash,reason,errors";
  for (const std::string& expectation : campaign.expectations()) line += ',' + csv_cell("margin: " + expectation);
  stream << line << '\n';
  for (std::size_t i = 0; i < table.size(); ++i) {
    line = fmt::format("{}", i);
    for (const std::string& value : campaign.values_of(static_cast<std::int64_t>(i))) line += ',' + csv_cell(value);
    if (table.has(i)) {
      const bool passed = table.passed(i);
      line += fmt::format(",{},{},{},{},{},{}", to_string(*table.verdicts[i]),
                          table.failing_ticks[i] < 0 ? "" : fmt::format("{}", table.failing_ticks[i]), table.ticks[i],
                          table.hashes[i] == 0 ? "" : hash_text(table.hashes[i]),
                          passed ? "" : csv_cell(table.reason_texts[table.reasons[i]]), table.errors[i]);
    } else {
      line += ",missing,,,,,";
    }
    for (const std::vector<double>& margins : table.margins)
      line += std::isnan(margins[i]) ? "," : fmt::format(",{}", margins[i]);
    stream << line << '\n';
  }
  stream.close();
  std::error_code failed;
  if (stream) fs::rename(draft, file, failed);
  if (!stream || failed) return error_in(file.string(), "it can't be written", "is the disk full?");
  return {};
}

Json json_of_report(const Campaign& campaign, const CaseTable& table, const CampaignSummary& summary) {
  Json report{{"schema", 1},
              {"scenario", campaign.scenario().name},
              {"seed", campaign.options().seed},
              {"plan", campaign.digest()},
              {"summary", json_of_summary(summary)},
              {"nominal",
               {{"verdict", std::string(to_string(campaign.nominal().verdict))},
                {"sentence", campaign.nominal().sentence},
                {"hash", campaign.nominal().hash}}},
              {"failures", failures_of(table)},
              {"errors", errors_of(table)}};
  report["parameters"] = Json::array();
  const std::size_t count = campaign.scenario().variations.size();
  for (std::size_t i = 0; i < count; ++i) report["parameters"].push_back(json_of_parameter(campaign, table, i));
  report["margins"] = Json::array();
  for (std::size_t i = 0; i < table.margins.size(); ++i)
    report["margins"].push_back(json_of_margins(campaign, table, i));
  report["cells"] = Json::array();
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) report["cells"].push_back(cells_of(campaign, table, a, b));
  return report;
}

}  // namespace

Result<CaseTable> CaseTable::of(const Campaign& campaign) {
  CaseTable table;
  const auto size = static_cast<std::size_t>(campaign.options().cases);
  table.verdicts.resize(size);
  table.ticks.assign(size, -1);
  table.failing_ticks.assign(size, -1);
  table.hashes.resize(size);
  table.reasons.resize(size);
  table.errors.resize(size);
  table.margins.assign(campaign.expectations().size(), std::vector<double>(size, none));
  std::map<std::string, std::size_t> places;
  std::vector<std::int64_t> lowest;  // case by reason
  std::vector<CaseResult> second_runs;
  auto read = campaign.read_results([&](const CaseResult& result) {
    const auto i = static_cast<std::size_t>(result.number);
    if (result.again || table.verdicts[i]) return second_runs.push_back(result);
    table.verdicts[i] = result.verdict;
    table.ticks[i] = result.ticks;
    table.failing_ticks[i] = result.tick.value_or(-1);
    table.hashes[i] = hash_of_text(result.hash);
    table.errors[i] = result.errors;
    if (result.errors > 0) table.first_errors[result.number] = result.first_error;
    const auto [place, is_new] = places.emplace(result.reason, places.size());
    table.reasons[i] = place->second;
    if (is_new) {
      table.reason_texts.push_back(result.reason);
      table.reason_examples.emplace_back();
      lowest.push_back(result.number + 1);
    }
    if (result.number < lowest[place->second]) {
      table.reason_examples[place->second] = result.sentence;
      lowest[place->second] = result.number;
    }
    table.reached.resize(std::max(table.reached.size(), result.reached.size()));
    for (std::size_t condition = 0; condition < result.reached.size(); ++condition)
      table.reached[condition] += result.reached[condition] ? 1 : 0;
    for (std::size_t e = 0; e < std::min(table.margins.size(), result.margins.size()); ++e)
      table.margins[e][i] = result.margins[e].value_or(none);
  });
  if (!read) return read.errors();
  std::set<std::int64_t> twice, different;
  for (const CaseResult& second : second_runs) {
    const auto i = static_cast<std::size_t>(second.number);
    if (!table.verdicts[i]) continue;  // another process hasn't made the first run yet
    twice.insert(second.number);
    const bool is_same = table.verdicts[i] == second.verdict && table.hashes[i] == hash_of_text(second.hash) &&
                         table.failing_ticks[i] == second.tick.value_or(-1) && table.ticks[i] == second.ticks;
    if (!is_same) different.insert(second.number);
  }
  table.repeated = static_cast<std::int64_t>(twice.size());
  for (const std::int64_t number : different)
    if (table.unrepeated.size() < most_unrepeated) table.unrepeated.push_back(number);
  read_values(campaign, table);
  return table;
}

Result<CampaignSummary> summary_of(const Campaign& campaign) {
  const auto table = REHEARSE_TRY(CaseTable::of(campaign));
  return summary_of(campaign, table);
}

std::string verdict(const CampaignSummary& summary) {
  if (!summary.unrepeated.empty())
    return fmt::format("the campaign doesn't repeat itself: case {} gave another result in another process",
                       summary.unrepeated.front());
  if (summary.judged() == 0) return fmt::format("none of {} cases has a result", summary.cases);
  const Interval interval = summary.interval();
  const std::string range = fmt::format("{:.4g} % to {:.4g} %", 100.0 * interval.low, 100.0 * interval.high);
  std::string text = fmt::format("{} of {} cases pass", summary.passed(), summary.judged());
  if (summary.until_failures == 1)
    text += fmt::format("; the work ended with the first failure, so the share that passes is within {}", range);
  else if (summary.until_failures > 1)
    text += fmt::format("; the work ended with failure {}, so the share that passes is about {:.4g} % ({})",
                        summary.until_failures, 100.0 * summary.share(), range);
  else
    text += fmt::format(": {:.4g} % ({})", 100.0 * summary.share(), range);
  if (summary.claim) text += "; " + claim_sentence(summary);
  if (summary.pairs) text += "; " + comparison_sentence(*summary.pairs, summary.non_inferiority);
  if (summary.missing > 0) text += fmt::format("; {} have no result yet", summary.missing);
  if (const auto names = summary.never_tried(); !names.empty())
    text = fmt::format("never tried: no case reached {}; {}", fmt::join(names, ", "), text);
  return text;
}

std::string error_sentence(const CampaignSummary& summary) {
  if (summary.with_errors == 0) return "";
  return fmt::format("in {} controllers wrote errors or numbers that aren't finite; {} of them {}",
                     count_text(summary.with_errors, "case"), summary.passed_with_errors,
                     summary.passed_with_errors == 1 ? "passes" : "pass");
}

std::string to_json(const CampaignSummary& summary) { return json_of_summary(summary).dump(); }

Result<CampaignSummary> write_campaign_report(const Campaign& campaign, const Campaign* against,
                                              const std::optional<double>& margin) {
  const auto table = REHEARSE_TRY(CaseTable::of(campaign));
  CampaignSummary summary = summary_of(campaign, table);
  std::optional<CaseTable> before;
  if (against) {
    REHEARSE_TRY(check_comparable(campaign, *against, margin.has_value()));
    auto read = REHEARSE_TRY(CaseTable::of(*against));
    before = std::move(read);
    summary.pairs = paired_cases(table, *before);
    if (margin) summary.non_inferiority = NonInferiority{*margin, summary.confidence()};
  }
  Json report = json_of_report(campaign, table, summary);
  if (before) {
    report["against"] = json_of_change(table, *before, summary);
    report["against"]["differences"] = differences(*against, campaign);
  }
  REHEARSE_TRY(write_csv(campaign, table));
  const fs::path& folder = campaign.folder();
  const std::string json = report.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
  REHEARSE_TRY(replace_text(folder / "report.json", json));
  REHEARSE_TRY(replace_text(folder / "report.md", markdown_of(report)));
  REHEARSE_TRY(replace_text(folder / "report.html", page_of(campaign, table, report)));
  return summary;
}

}  // namespace rehearse
