#include "comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {
namespace {

constexpr std::size_t listed_flips = 20;

/// Calls `take` with each case that has a result in both campaigns.
template <class Take>
void for_each_pair(const CaseTable& now, const CaseTable& before, Take take) {
  for (std::size_t i = 0; i < std::min(now.size(), before.size()); ++i)
    if (now.has(i) && before.has(i)) take(i);
}

/// The cases that passed in one campaign and not in the other.
std::vector<std::int64_t> flips(const CaseTable& passed, const CaseTable& failed) {
  std::vector<std::int64_t> cases;
  for_each_pair(passed, failed, [&](std::size_t i) {
    if (passed.passed(i) && !failed.passed(i)) cases.push_back(static_cast<std::int64_t>(i));
  });
  return cases;
}

std::vector<std::int64_t> first_flips(std::vector<std::int64_t> cases) {
  cases.resize(std::min(cases.size(), listed_flips));
  return cases;
}

}  // namespace

PairedCases paired_cases(const CaseTable& now, const CaseTable& before) {
  PairedCases pairs;
  for_each_pair(now, before, [&](std::size_t) { ++pairs.all; });
  pairs.broken = static_cast<std::int64_t>(flips(before, now).size());
  pairs.mended = static_cast<std::int64_t>(flips(now, before).size());
  return pairs;
}

CampaignChange change_between(const CaseTable& before, const CaseTable& now, const CampaignSummary& summary) {
  CampaignChange change{.pairs = *summary.pairs};
  for_each_pair(now, before, [&](std::size_t i) { change.same_bits += now.hashes[i] == before.hashes[i] ? 1 : 0; });
  change.p = mcnemar_exact(change.pairs.broken, change.pairs.mended);
  if (const double difference = change.pairs.difference(); std::isfinite(difference)) change.difference = difference;
  change.interval = paired_interval(change.pairs, summary.confidence());
  change.broken_cases = first_flips(flips(before, now));
  change.mended_cases = first_flips(flips(now, before));
  return change;
}

Result<void> check_comparable(const Campaign& now, const Campaign& before, bool claims_margin) {
  if (before.digest() != now.digest())
    return error_in(before.folder().string(),
                    fmt::format("its plan differs from that of {}: their cases can't be paired", now.folder().string()),
                    "run both with the same vary:, --cases and --seed");
  if (!claims_margin) return {};
  for (const Campaign* campaign : {&before, &now}) {
    const auto summary = REHEARSE_TRY(summary_of(*campaign));
    if (summary.until_failures == 0) continue;
    const std::string folder = campaign->folder().string();
    return error_in(folder,
                    fmt::format("the work ended with failure {}: its cases aren't a fair sample for a margin",
                                summary.until_failures),
                    fmt::format("run the others: rehearse sweep resume {}", folder));
  }
  return {};
}

}  // namespace rehearse
