#include "comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "report_json.h"

namespace rehearse {
namespace {

using Json = nlohmann::ordered_json;

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

Json first_of(std::vector<std::int64_t> cases) {
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

Json json_of_change(const CaseTable& now, const CaseTable& before, const CampaignSummary& summary) {
  const PairedCases& pairs = *summary.pairs;
  std::int64_t same_bits = 0;
  for_each_pair(now, before, [&](std::size_t i) { same_bits += now.hashes[i] == before.hashes[i] ? 1 : 0; });
  return {{"compared", pairs.all},
          {"same_bits", same_bits},
          {"broken", pairs.broken},
          {"mended", pairs.mended},
          {"p", mcnemar_exact(pairs.broken, pairs.mended)},
          {"difference", number_or_null(pairs.difference())},
          {"interval", json_of_interval(paired_interval(pairs, summary.confidence()))},
          {"broken_cases", first_of(flips(before, now))},
          {"mended_cases", first_of(flips(now, before))}};
}

Json json_of_non_inferiority(const CampaignSummary& summary) {
  if (!summary.non_inferiority) return nullptr;
  const NonInferiority& claim = *summary.non_inferiority;
  const auto more = more_pairs(claim, *summary.pairs);
  return {{"margin", claim.margin},
          {"confidence", claim.confidence},
          {"difference", number_or_null(summary.pairs->difference())},
          {"interval", json_of_interval(paired_interval(*summary.pairs, claim.confidence))},
          {"answer", std::string(to_string(answer_of(claim, *summary.pairs)))},
          {"more_cases", more ? Json(*more) : Json(nullptr)}};
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
