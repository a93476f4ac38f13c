// The same cases before and after a change: flips, the interval of their difference, and non-inferiority.
#include <fmt/format.h>
#include <rehearse/campaign_report.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "core/scenario/normal_quantile.h"

namespace rehearse {
namespace {

/// The score statistic of a difference of the shares: its distance from the observed one in deviations, at the most
/// likely probabilities that have this difference.
double score(const PairedCases& pairs, double difference) {
  const double n = static_cast<double>(pairs.all), broken = static_cast<double>(pairs.broken),
               mended = static_cast<double>(pairs.mended);
  const double a = 2.0 * n, b = (2.0 * n - mended + broken) * difference - mended - broken,
               c = -broken * difference * (1.0 - difference);
  const double probability_broken = (std::sqrt(std::max(0.0, b * b - 4.0 * a * c)) - b) / (2.0 * a);
  const double distance = mended - broken - n * difference;
  const double variance = n * (2.0 * probability_broken + difference * (1.0 - difference));
  if (variance > 0.0) return distance / std::sqrt(variance);
  return distance == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), distance);
}

/// The difference between `inside`, whose score is below z in size, and `outside` at which the score reaches z.
double end_of_interval(const PairedCases& pairs, double inside, double outside, double z) {
  if (std::abs(score(pairs, outside)) <= z) return outside;
  constexpr int halvings = 80;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (std::abs(score(pairs, middle)) <= z ? inside : outside) = middle;
  }
  return inside;
}

double quantile_of(const NonInferiority& claim) { return normal_quantile(0.5 + 0.5 * claim.confidence); }

}  // namespace

double PairedCases::difference() const { return static_cast<double>(mended - broken) / static_cast<double>(all); }

Interval paired_interval(const PairedCases& pairs, double confidence) {
  if (pairs.all == 0) return {-1.0, 1.0};
  const double z = normal_quantile(0.5 + 0.5 * confidence), observed = pairs.difference();
  return {end_of_interval(pairs, observed, -1.0, z), end_of_interval(pairs, observed, 1.0, z)};
}

ClaimAnswer answer_of(const NonInferiority& claim, const PairedCases& pairs) {
  if (pairs.all == 0) return ClaimAnswer::undecided;
  const double at_margin = score(pairs, -claim.margin), z = quantile_of(claim);
  if (std::abs(at_margin) <= z) return ClaimAnswer::undecided;
  return at_margin > 0.0 ? ClaimAnswer::passes : ClaimAnswer::fails;
}

std::optional<std::int64_t> more_pairs(const NonInferiority& claim, const PairedCases& pairs) {
  if (pairs.all == 0 || answer_of(claim, pairs) != ClaimAnswer::undecided) return std::nullopt;
  // the score grows with the root of the number of pairs if the shares of flips stay
  const double ratio = quantile_of(claim) / score(pairs, -claim.margin);
  const double all = std::floor(static_cast<double>(pairs.all) * ratio * ratio) + 1.0;
  constexpr double most = 1e12;
  if (!(all <= most)) return std::nullopt;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(all) - pairs.all);
}

std::string comparison_sentence(const PairedCases& pairs, const std::optional<NonInferiority>& claim) {
  if (pairs.all == 0) return "no case has a result in both campaigns";
  const Interval interval = paired_interval(pairs, claim ? claim->confidence : 0.95);
  std::string text = fmt::format(
      "{} passed before and {}, {} failed before and {}: the share that passes changes by {:.4g} % ({:.4g} % to "
      "{:.4g} %)",
      count_text(pairs.broken, "case"), pairs.broken == 1 ? "fails now" : "fail now", pairs.mended,
      pairs.mended == 1 ? "passes now" : "pass now", 100.0 * pairs.difference(), 100.0 * interval.low,
      100.0 * interval.high);
  if (!claim) return text;
  const std::string with = fmt::format("with a margin of {:.6g} % and {:.6g} % confidence", 100.0 * claim->margin,
                                       100.0 * claim->confidence);
  switch (answer_of(*claim, pairs)) {
    case ClaimAnswer::passes: return text + "; not inferior, " + with;
    case ClaimAnswer::fails: return text + "; inferior, " + with;
    case ClaimAnswer::undecided: break;
  }
  const auto more = more_pairs(*claim, pairs);
  return text + fmt::format("; undecided whether it is inferior, {}: {}", with,
                            more ? count_text(*more, "more case") + " would decide it if the shares of flips stay"
                                 : "no number of cases decides it if the shares of flips stay");
}

}  // namespace rehearse
