// The interval of the difference of two shares over the same cases, and the claim that it isn't below a margin.
#include <rehearse/campaign_report.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace rehearse {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr double z = 1.959963984540054;  // the normal quantile of 0.975

/// The logarithm of the likelihood of these flips, without its constant.
double log_likelihood(const PairedCases& pairs, double broken, double mended) {
  const auto term = [](std::int64_t count, double probability) {
    return count == 0 ? 0.0 : static_cast<double>(count) * std::log(probability);
  };
  return term(pairs.broken, broken) + term(pairs.mended, mended) +
         term(pairs.all - pairs.broken - pairs.mended, 1.0 - broken - mended);
}

/// The score of a difference at the likeliest probability of a broken case, which is searched by sections.
double score_by_search(const PairedCases& pairs, double difference) {
  double low = std::max(0.0, -difference), high = 0.5 * (1.0 - difference);
  for (int i = 0; i < 200; ++i) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    if (log_likelihood(pairs, a, a + difference) < log_likelihood(pairs, b, b + difference))
      low = a;
    else
      high = b;
  }
  const double n = static_cast<double>(pairs.all);
  const double variance = 2.0 * low + difference - difference * difference;
  return (pairs.difference() - difference) / std::sqrt(variance / n);
}

TEST(PairedInterval, EndsWhereTheScoreOfTheLikeliestProbabilitiesIsThatOfTheConfidence) {
  for (const PairedCases pairs : {PairedCases{44, 3, 1}, PairedCases{200, 12, 3}, PairedCases{50, 0, 7},
                                  PairedCases{1000, 40, 60}, PairedCases{30, 9, 9}}) {
    const Interval interval = paired_interval(pairs);
    EXPECT_NEAR(score_by_search(pairs, interval.low), z, 1e-5) << pairs.broken << ' ' << pairs.mended;
    EXPECT_NEAR(score_by_search(pairs, interval.high), -z, 1e-5) << pairs.broken << ' ' << pairs.mended;
  }
}

TEST(PairedInterval, HasAClosedFormWithoutFlips) {
  for (const std::int64_t n : {5, 100, 10'000}) {
    const double reach = z * z / (static_cast<double>(n) + z * z);  // of score² = n m / (1 - m)
    EXPECT_NEAR(paired_interval({n, 0, 0}).low, -reach, 1e-12);
    EXPECT_NEAR(paired_interval({n, 0, 0}).high, reach, 1e-12);
  }
}

TEST(PairedInterval, StaysWithinItsBounds) {
  EXPECT_EQ(paired_interval({20, 20, 0}).low, -1.0);
  EXPECT_EQ(paired_interval({20, 0, 20}).high, 1.0);
  EXPECT_LT(paired_interval({20, 20, 0}).high, 0.0);
  EXPECT_EQ(paired_interval({}).low, -1.0);
  EXPECT_EQ(paired_interval({}).high, 1.0);
}

TEST(PairedInterval, IsMirroredIfTheCampaignsChangePlaces) {
  const Interval there = paired_interval({80, 11, 4}), back = paired_interval({80, 4, 11});
  EXPECT_NEAR(there.low, -back.high, 1e-12);
  EXPECT_NEAR(there.high, -back.low, 1e-12);
}

/// The probability that the interval contains the true difference, from all outcomes of n pairs.
double coverage(std::int64_t n, double broken, double mended) {
  double sum = 0.0;
  for (std::int64_t b = 0; b <= n; ++b)
    for (std::int64_t m = 0; b + m <= n; ++m) {
      const PairedCases pairs{n, b, m};
      const Interval interval = paired_interval(pairs);
      if (interval.low > mended - broken || interval.high < mended - broken) continue;
      const auto factorial = [](std::int64_t count) { return std::lgamma(static_cast<double>(count) + 1.0); };
      sum += std::exp(factorial(n) - factorial(b) - factorial(m) - factorial(n - b - m) +
                      log_likelihood(pairs, broken, mended));
    }
  return sum;
}

TEST(PairedInterval, ContainsTheTrueDifferenceAsOftenAsItsConfidence) {
  double least = 1.0, mean = 0.0;
  int count = 0;
  for (const double broken : {0.02, 0.05, 0.1, 0.2, 0.35})
    for (const double mended : {0.02, 0.05, 0.1, 0.2, 0.35}) {
      const double found = coverage(40, broken, mended);
      least = std::min(least, found);
      mean += found;
      ++count;
    }
  EXPECT_GT(least, 0.92);
  EXPECT_NEAR(mean / count, 0.955, 0.01);
}

TEST(NonInferiority, HasThreeAnswersThatAreThoseOfTheInterval) {
  for (std::int64_t broken = 0; broken <= 30; ++broken)
    for (const double margin : {0.01, 0.05, 0.1}) {
      const PairedCases pairs{200, broken, 4};
      const Interval interval = paired_interval(pairs);
      const ClaimAnswer wanted = interval.low > -margin    ? ClaimAnswer::passes
                                 : interval.high < -margin ? ClaimAnswer::fails
                                                           : ClaimAnswer::undecided;
      EXPECT_EQ(answer_of({margin}, pairs), wanted) << broken << ", margin " << margin;
    }
  EXPECT_EQ(answer_of({0.05}, PairedCases{200, 4, 4}), ClaimAnswer::passes);
  EXPECT_EQ(answer_of({0.05}, PairedCases{200, 12, 4}), ClaimAnswer::undecided);
  EXPECT_EQ(answer_of({0.05}, PairedCases{200, 40, 4}), ClaimAnswer::fails);
  EXPECT_EQ(answer_of({0.05}, PairedCases{}), ClaimAnswer::undecided);
}

TEST(NonInferiority, AsksForAsManyCasesAsDecideIt) {
  const NonInferiority claim{0.05};
  const PairedCases few{100, 4, 2};
  const auto more = more_pairs(claim, few);
  ASSERT_TRUE(more.has_value());
  // the same shares of flips, in so many pairs: an equation of real numbers, so the counts are multiples
  const auto times = [&](std::int64_t factor) {
    return PairedCases{factor * few.all, factor * few.broken, factor * few.mended};
  };
  const std::int64_t enough = (few.all + *more + few.all - 1) / few.all;
  EXPECT_EQ(answer_of(claim, times(enough)), ClaimAnswer::passes);
  EXPECT_EQ(answer_of(claim, times(enough - 1)), ClaimAnswer::undecided);
  EXPECT_EQ(more_pairs(claim, times(enough)), std::nullopt) << "it is decided";
  EXPECT_EQ(more_pairs(claim, PairedCases{100, 5, 0}), std::nullopt) << "the difference is the margin";
}

TEST(NonInferiority, IsStatedInASentence) {
  EXPECT_EQ(
      comparison_sentence({200, 12, 4}, std::nullopt).substr(0, 105),
      "12 cases passed before and fail now, 4 failed before and pass now: the share that passes changes by -4 % ");
  EXPECT_THAT(comparison_sentence({200, 1, 1}, NonInferiority{0.05}),
              HasSubstr("1 case passed before and fails now, 1 failed before and passes now"));
  EXPECT_THAT(comparison_sentence({200, 1, 1}, NonInferiority{0.05}),
              EndsWith("; not inferior, with a margin of 5 % and 95 % confidence"));
  EXPECT_THAT(comparison_sentence({200, 40, 4}, NonInferiority{0.05}),
              EndsWith("; inferior, with a margin of 5 % and 95 % confidence"));
  EXPECT_THAT(comparison_sentence({200, 12, 4}, NonInferiority{0.05}),
              HasSubstr("; undecided whether it is inferior, with a margin of 5 % and 95 % confidence: "));
  EXPECT_EQ(comparison_sentence({}, std::nullopt), "no case has a result in both campaigns");
}

TEST(NonInferiority, IsJudgedBesideThePassRate) {
  CampaignSummary summary;
  summary.cases = 200;
  summary.verdicts[0] = 180;  // passed
  summary.verdicts[1] = 20;   // violated
  EXPECT_EQ(summary.answer(), ClaimAnswer::fails) << "nothing is claimed: every case must pass";
  summary.pairs = PairedCases{200, 4, 4};
  EXPECT_EQ(summary.answer(), ClaimAnswer::fails);
  summary.non_inferiority = NonInferiority{0.05};
  EXPECT_EQ(summary.answer(), ClaimAnswer::passes) << "some cases failed before, too";
  summary.claim = ClaimedRate{0.9};
  EXPECT_EQ(summary.answer(), ClaimAnswer::undecided) << "of the rate";
  summary.claim = ClaimedRate{0.99};
  EXPECT_EQ(summary.answer(), ClaimAnswer::fails);
  summary.claim = ClaimedRate{0.8};
  EXPECT_EQ(summary.answer(), ClaimAnswer::passes);
  summary.pairs = PairedCases{200, 40, 4};
  EXPECT_EQ(summary.answer(), ClaimAnswer::fails) << "of the pairs";
}

}  // namespace
}  // namespace rehearse
