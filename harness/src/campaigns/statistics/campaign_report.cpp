// The results of a campaign: its summary, and the files of its report.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>

#include "base/hashing.h"
#include "base/text.h"
#include "campaign_findings.h"
#include "campaign_page.h"
#include "campaigns/plan/campaign_folder.h"
#include "campaigns/plan/csv_text.h"
#include "case_table.h"
#include "comparison.h"
#include "core/golden/golden_files.h"
#include "core/scenario/campaign_claims.h"
#include "fault_matrix.h"
#include "report_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

CampaignSummary summary_of(const Campaign& campaign, const CaseTable& table) {
  CampaignSummary summary;
  summary.cases = static_cast<std::int64_t>(table.size());
  for (const auto& verdict : table.verdicts) {
    if (verdict)
      ++summary.verdicts[static_cast<std::size_t>(*verdict)];
    else
      ++summary.missing;
  }
  for (const FailureKind& failure : failures_of(table)) {  // the most frequent first
    auto& [reason, count] = summary.reasons[static_cast<std::size_t>(failure.verdict)];
    if (count++ == 0) reason = failure.reason;
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

}  // namespace

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

Result<CampaignSummary> write_campaign_report(const Campaign& campaign, const Campaign* against,
                                              const std::optional<double>& margin) {
  const auto table = REHEARSE_TRY(CaseTable::of(campaign));
  CampaignSummary summary = summary_of(campaign, table);
  std::optional<CaseTable> before;
  if (against) {
    REHEARSE_TRY(check_comparable(campaign, *against, margin.has_value()));
    before = REHEARSE_TRY(CaseTable::of(*against));
    summary.pairs = paired_cases(table, *before);
    if (margin) summary.non_inferiority = NonInferiority{*margin, summary.confidence()};
  }
  auto findings = CampaignFindings::of(campaign, table, summary);
  if (before) {
    findings.against = change_between(*before, table, summary);
    findings.against->differences = differences(*against, campaign);
  }
  REHEARSE_TRY(write_csv(campaign, table));
  const fs::path& folder = campaign.folder();
  REHEARSE_TRY(replace_text(folder / "report.json", json_of(findings)));
  REHEARSE_TRY(replace_text(folder / "report.md", markdown_of(findings)));
  REHEARSE_TRY(replace_text(folder / "report.html", page_of(campaign, table, findings)));
  return summary;
}

}  // namespace rehearse
