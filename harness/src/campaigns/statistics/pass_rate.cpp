// The claim on the share of cases that pass, and its three answers.
#include <fmt/format.h>
#include <rehearse/campaign_report.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "binomial.h"

namespace rehearse {
namespace {

/// True if the exact interval of n cases, of which this share passes, doesn't contain the bound: so many passing cases,
/// or so few, are at most as probable at the bound as the interval leaves beyond an end.
bool decides(const ClaimedRate& claim, double share, double n) {
  const double tail = 0.5 - 0.5 * claim.confidence, passed = share * n;
  if (share > claim.at_least) return binomial_at_least(passed, n, claim.at_least) <= tail;
  return share < claim.at_least && binomial_at_most(passed, n, claim.at_least) < tail;
}

}  // namespace

std::string_view to_string(ClaimAnswer answer) {
  switch (answer) {
    case ClaimAnswer::passes: return "passes";
    case ClaimAnswer::fails: return "fails";
    case ClaimAnswer::undecided: return "undecided";
  }
  return "";
}

ClaimAnswer answer_of(const ClaimedRate& claim, const Interval& interval) {
  if (interval.low >= claim.at_least) return ClaimAnswer::passes;
  return interval.high < claim.at_least ? ClaimAnswer::fails : ClaimAnswer::undecided;
}

std::optional<std::int64_t> deciding_cases(const ClaimedRate& claim, double share) {
  constexpr std::int64_t most = 1'000'000'000;
  if (std::isnan(share) || !decides(claim, share, static_cast<double>(most))) return std::nullopt;
  std::int64_t low = 0, high = most;  // low doesn't decide
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (decides(claim, share, static_cast<double>(middle)) ? high : low) = middle;
  }
  return high;
}

std::string plan_sentence(const ClaimedRate& claim, std::int64_t cases) {
  const double between = 0.5 * (1.0 + claim.at_least);
  const std::int64_t least = *deciding_cases(claim, 1.0);
  std::string text = fmt::format(
      "that at least {:.6g} % pass, with {:.6g} % confidence, needs {} cases if all pass, and {} if {:.6g} % pass",
      100.0 * claim.at_least, 100.0 * claim.confidence, least, deciding_cases(claim, between).value_or(0),
      100.0 * between);
  if (cases < least) text += fmt::format("; this plan has {}, which can't show it", cases);
  return text;
}

ClaimAnswer CampaignSummary::rate_answer() const {
  if (claim) return answer_of(*claim, interval());
  return failed() == 0 ? ClaimAnswer::passes : ClaimAnswer::fails;
}

ClaimAnswer CampaignSummary::answer() const {
  if (!non_inferiority) return rate_answer();
  const ClaimAnswer of_pairs = answer_of(*non_inferiority, *pairs);
  if (!claim) return of_pairs;  // some cases may fail, as some did before
  for (const ClaimAnswer worst : {ClaimAnswer::fails, ClaimAnswer::undecided})
    if (of_pairs == worst || rate_answer() == worst) return worst;
  return ClaimAnswer::passes;
}

std::optional<std::int64_t> CampaignSummary::more_cases() const {
  if (!claim || rate_answer() != ClaimAnswer::undecided) return std::nullopt;
  const auto all = deciding_cases(*claim, share());
  if (!all) return std::nullopt;
  return std::max<std::int64_t>(1, *all - judged());
}

std::string claim_sentence(const CampaignSummary& summary) {
  REHEARSE_ASSERT(summary.claim, "the campaign has a claim");
  const std::string what = fmt::format("at least {:.6g} % pass, with {:.6g} % confidence",
                                       100.0 * summary.claim->at_least, 100.0 * summary.claim->confidence);
  switch (summary.rate_answer()) {
    case ClaimAnswer::passes: return what;
    case ClaimAnswer::fails: return "it is false that " + what;
    case ClaimAnswer::undecided: break;
  }
  const auto more = summary.more_cases();
  return fmt::format("it is undecided whether {}: {}", what,
                     more ? count_text(*more, "more case") + " would decide it if the rate stays"
                          : "no number of cases decides it if the rate stays");
}

std::vector<std::string> CampaignSummary::never_tried() const {
  std::vector<std::string> names;
  for (const auto& [name, count] : reached)
    if (count == 0 && missing == 0) names.push_back(name);
  return names;
}

}  // namespace rehearse
