// The values of cases, and the statistics of campaigns.
#include "campaigns/plan/case_values.h"
#include "campaigns/plan/csv_text.h"
#include "campaigns/plan/result_lines.h"
#include "campaigns/run/case_run.h"
#include "scenario_files.h"

#include <rehearse/shrink.h>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

const std::string world =
    "rehearse: 1\nduration: 1\nseed: 1\nbodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 2, position: [0, 0, "
    "1]}\npushes:\n  - {body: Box, force: [1, 2, 3], from: 0.1, until: 0.2}\nvary:\n";

const std::string mass = "  mass: {path: bodies.Box.mass, uniform: [1, 3]}\n";
const std::string height = "  height: {path: \"bodies.Box.position[2]\", uniform: [1, 2]}\n";

std::shared_ptr<const CaseValues> values(const std::string& vary, std::uint64_t seed = 0) {
  auto made = CaseValues::make(loaded(world + vary), seed);
  REHEARSE_ASSERT(made.ok(), "the variations of a test are valid");
  return *made;
}

Variation numbers(Distribution distribution, double low, double high, double mean = 0.0, double stddev = 1.0) {
  Variation variation;
  variation.distribution = distribution;
  variation.low = low;
  variation.high = high;
  variation.mean = mean;
  variation.stddev = stddev;
  return variation;
}

// computed with the reference implementation of XXH3 by the formula in case_values.h
TEST(CaseValues, AreFunctionsOfSeedCaseAndName) {
  EXPECT_EQ(uniform_number(0, 0, "mass"), 0.7054647504170638);
  EXPECT_EQ(uniform_number(0, 1, "mass"), 0.16732749348306142);
  EXPECT_EQ(uniform_number(7, 0, "mass"), 0.27862744285385588);
  EXPECT_EQ(uniform_number(0, 0, "push_x"), 0.79796251123474449);
  EXPECT_EQ(uniform_number(123456789, 999999, "friction"), 0.40484068593212441);
}

TEST(CaseValues, DontDependOnOtherParameters) {
  const auto alone = values(mass), beside = values(height + mass);
  for (std::int64_t number = 0; number < 50; ++number) EXPECT_EQ(alone->of(number)[0], beside->of(number)[1]);
  EXPECT_NE(values(mass, 1)->of(0)[0], alone->of(0)[0]) << "another seed";
}

TEST(CaseValues, FillTheirDistributions) {
  constexpr int count = 4000;
  std::vector<double> shares;
  for (int i = 0; i < count; ++i) shares.push_back(uniform_number(5, i, "a"));
  std::ranges::sort(shares);
  double farthest = 0.0;  // Kolmogorov's distance; 1.36 / sqrt(n) is exceeded in 5 % of all seeds
  for (int i = 0; i < count; ++i)
    farthest = std::max(farthest, std::abs(shares[static_cast<std::size_t>(i)] - (i + 0.5) / count));
  EXPECT_LT(farthest, 1.36 / std::sqrt(count));
}

// The quantiles of the normal distribution are in any table of it.
TEST(Quantiles, AreThoseOfTheirDistributions) {
  EXPECT_EQ(quantile_of(numbers(Distribution::uniform, 2, 4), 0.25), 2.5);
  EXPECT_NEAR(quantile_of(numbers(Distribution::log_uniform, 0.01, 100), 0.75), 10.0, 1e-12);
  const Variation wide = numbers(Distribution::normal, -1e3, 1e3, 5, 2);
  EXPECT_NEAR(quantile_of(wide, 0.5), 5.0, 1e-12);
  EXPECT_NEAR(quantile_of(wide, 0.975), 5.0 + 2 * 1.959963984540054, 1e-9);
  // the positive half: its median is the quantile of 0.75
  EXPECT_NEAR(quantile_of(numbers(Distribution::normal, 0, 100), 0.5), 0.674489750196082, 1e-9);
  EXPECT_NEAR(quantile_of(numbers(Distribution::normal, -100, 0), 0.5), -0.674489750196082, 1e-9);
  // far out, where 1 - share has no digits left: Q(6) = 9.865876450377e-10, Q(6.111565) is half of it
  EXPECT_NEAR(quantile_of(numbers(Distribution::normal, 6, 60), 0.5), 6.1115650618134385, 1e-9);
  for (const double share : {1e-300, 1.0 - 1e-16}) {
    EXPECT_GE(quantile_of(numbers(Distribution::normal, -1, 1), share), -1.0);
    EXPECT_LE(quantile_of(numbers(Distribution::normal, -1, 1), share), 1.0);
  }
}

TEST(Quantiles, OfWholeNumbersAreAllAsLikely) {
  Variation dice = numbers(Distribution::uniform, 1, 6);
  dice.integer = true;
  std::map<double, int> counts;
  for (int i = 0; i < 600; ++i) ++counts[quantile_of(dice, (i + 0.5) / 600)];
  EXPECT_EQ(counts.size(), 6u);
  for (const auto& [number, count] : counts) EXPECT_EQ(count, 100) << number;
}

TEST(CaseValues, ChooseGoThroughGridsAndReadFiles) {
  write_file("table.csv", "a,height\n1,1.5\n2,2.5\n# and so on\n3,3.5\n");
  const auto all = values(
      "  x: {path: \"pushes[0].force[0]\", grid: [1, 2]}\n  y: {path: \"pushes[0].force[1]\", grid: {from: 0, to: 1, "
      "steps: 3}}\n  height: {path: \"bodies.Box.position[2]\", file: table.csv}\n  mass: {path: bodies.Box.mass, "
      "choice: [1, 5]}\n");
  std::set<std::pair<std::string, std::string>> cells;
  std::set<std::string> chosen;
  for (std::int64_t number = 0; number < 6; ++number) {
    const auto of_case = all->of(number);
    cells.emplace(of_case[0], of_case[1]);
    EXPECT_EQ(of_case[2], (std::vector<std::string>{"1.5", "2.5", "3.5"})[static_cast<std::size_t>(number % 3)]);
  }
  EXPECT_EQ(cells.size(), 6u) << "all combinations";
  EXPECT_EQ(*all->round(), 6);
  for (std::int64_t number = 0; number < 40; ++number) chosen.insert(all->of(number)[3]);
  EXPECT_EQ(chosen, (std::set<std::string>{"1", "5"}));
}

TEST(CaseValues, AreLinkedByExpressions) {
  const auto linked = values(mass + "  from: {path: \"pushes[0].from\", uniform: [0.2, 0.5]}\n" +
                             "  until: {path: \"pushes[0].until\", linked: \"from + 0.1 * min(mass, 2)\"}\n");
  for (std::int64_t number = 0; number < 20; ++number) {
    const auto of_case = linked->of(number);
    EXPECT_DOUBLE_EQ(std::stod(of_case[2]), std::stod(of_case[1]) + 0.1 * std::min(std::stod(of_case[0]), 2.0));
  }
  EXPECT_EQ(std::stod(linked->with_links({"1", "0.3", ""})[2]), 0.4);
  EXPECT_EQ(std::stod(linked->with_links({"", "", ""})[2]), 0.1 + 0.1 * 2.0) << "of the nominal values";
}

TEST(CaseValues, AreCheckedAtTheirBounds) {
  const auto made = CaseValues::make(loaded(world + "  mass: {path: bodies.Box.mass, uniform: [-1, 3]}\n"), 0);
  ASSERT_TRUE(made);
  const auto checked = (*made)->check_bounds();
  ASSERT_FALSE(checked);
  EXPECT_THAT(to_string(checked.errors()), HasSubstr(":9:3: error: with 'mass' at -1: mass is -1"));
}

// R. G. Newcombe, Two-sided confidence intervals for the single proportion: comparison of seven methods, Statistics in
// Medicine 17 (1998), table I, method 5.
TEST(Statistics, TheExactIntervalIsAsPublished) {
  const struct {
    std::int64_t passed, all;
    double low, high;
  } published[] = {{81, 263, 0.2527, 0.3676}, {15, 148, 0.0578, 0.1617}, {0, 20, 0.0, 0.1684}, {1, 29, 0.0009, 0.1776}};
  for (const auto& row : published) {
    const Interval interval = exact_interval(row.passed, row.all);
    EXPECT_NEAR(interval.low, row.low, 5e-5) << row.passed << "/" << row.all;
    EXPECT_NEAR(interval.high, row.high, 5e-5) << row.passed << "/" << row.all;
  }
  EXPECT_EQ(exact_interval(20, 20).high, 1.0);
  EXPECT_EQ(exact_interval(0, 0).low, 0.0);
  EXPECT_EQ(exact_interval(0, 0).high, 1.0);
}

/// Without a failure its lower end is the root of the tail, by hand.
TEST(Statistics, TheExactIntervalHasTheWantedConfidence) {
  EXPECT_NEAR(exact_interval(50, 50, 0.99).low, std::pow(0.005, 1.0 / 50.0), 1e-12);
  EXPECT_NEAR(exact_interval(0, 50, 0.9).high, 1.0 - std::pow(0.05, 1.0 / 50.0), 1e-12);
}

TEST(PassRate, HasThreeAnswers) {
  const ClaimedRate claim{0.9, 0.95};
  EXPECT_EQ(answer_of(claim, {0.91, 0.99}), ClaimAnswer::passes);
  EXPECT_EQ(answer_of(claim, {0.9, 0.99}), ClaimAnswer::passes);
  EXPECT_EQ(answer_of(claim, {0.89, 0.91}), ClaimAnswer::undecided);
  EXPECT_EQ(answer_of(claim, {0.8, 0.9}), ClaimAnswer::undecided);
  EXPECT_EQ(answer_of(claim, {0.8, 0.89}), ClaimAnswer::fails);
}

/// By hand: 0.95^n is 0.0262 with 71 cases, and 0.0249 with 72.
TEST(PassRate, IsDecidedByTheFewestCases) {
  const ClaimedRate claim{0.95, 0.95};
  EXPECT_EQ(deciding_cases(claim, 1.0), 72);
  EXPECT_EQ(deciding_cases(claim, 0.975), 295);
  EXPECT_EQ(deciding_cases(claim, 0.925), 360);
  EXPECT_EQ(deciding_cases(claim, 0.95), std::nullopt);
  EXPECT_EQ(deciding_cases(claim, std::nan("")), std::nullopt);
}

/// One failure of 17 has the probability 15.7 % at 0.99.
TEST(PassRate, IsNotFalseBecauseOfOneFailureInAFewCases) {
  CampaignSummary summary;
  summary.claim = ClaimedRate{0.99, 0.95};
  summary.cases = 17;
  summary.verdicts = {16, 1};
  EXPECT_EQ(summary.answer(), ClaimAnswer::undecided) << claim_sentence(summary);
}

/// The number and the interval agree, for shares that occur with the number.
TEST(PassRate, IsDecidedWhereTheIntervalLeavesTheBound) {
  for (const double bound : {0.5, 0.9, 0.99}) {
    for (const double confidence : {0.8, 0.95, 0.999}) {
      const ClaimedRate claim{bound, confidence};
      const std::int64_t least = *deciding_cases(claim, 1.0);
      EXPECT_EQ(answer_of(claim, exact_interval(least, least, confidence)), ClaimAnswer::passes);
      EXPECT_EQ(answer_of(claim, exact_interval(least - 1, least - 1, confidence)), ClaimAnswer::undecided);
      const std::int64_t none = *deciding_cases(claim, 0.0);
      EXPECT_EQ(answer_of(claim, exact_interval(0, none, confidence)), ClaimAnswer::fails) << bound;
      if (none > 1) {
        EXPECT_EQ(answer_of(claim, exact_interval(0, none - 1, confidence)), ClaimAnswer::undecided) << bound;
      }
    }
  }
}

TEST(PassRate, OfAPlanSaysWhatItNeeds) {
  EXPECT_EQ(plan_sentence({0.95, 0.95}, 72),
            "that at least 95 % pass, with 95 % confidence, needs 72 cases if all pass, and 295 if 97.5 % pass");
  EXPECT_THAT(plan_sentence({0.95, 0.95}, 71), ::testing::EndsWith("; this plan has 71, which can't show it"));
}

TEST(PassRate, AsksForMoreCasesIfItIsUndecided) {
  CampaignSummary summary;
  summary.claim = ClaimedRate{0.95, 0.95};
  summary.cases = 200;
  summary.verdicts = {194, 6};
  EXPECT_EQ(summary.answer(), ClaimAnswer::undecided);
  EXPECT_EQ(summary.more_cases(), 261);
  EXPECT_EQ(claim_sentence(summary),
            "it is undecided whether at least 95 % pass, with 95 % confidence: 261 more cases "
            "would decide it if the rate stays");
  summary.verdicts = {190, 10};
  EXPECT_THAT(claim_sentence(summary), HasSubstr("no number of cases decides it if the rate stays"));
  summary.verdicts = {200, 0};
  EXPECT_EQ(claim_sentence(summary), "at least 95 % pass, with 95 % confidence");
  EXPECT_EQ(summary.more_cases(), std::nullopt);
  summary.verdicts = {150, 50};
  EXPECT_EQ(claim_sentence(summary), "it is false that at least 95 % pass, with 95 % confidence");
}

TEST(PassRate, IsThatOfAllCasesWithoutAClaim) {
  CampaignSummary summary;
  summary.cases = 2;
  summary.verdicts = {2};
  EXPECT_EQ(summary.answer(), ClaimAnswer::passes);
  summary.verdicts = {1, 1};
  EXPECT_EQ(summary.answer(), ClaimAnswer::fails);
}

TEST(Statistics, McNemarsTestIsThatOfTheBinomialDistribution) {
  EXPECT_NEAR(mcnemar_exact(8, 2), 2.0 * (1 + 10 + 45) / 1024, 1e-12);
  EXPECT_NEAR(mcnemar_exact(0, 5), 0.0625, 1e-12);
  EXPECT_EQ(mcnemar_exact(3, 3), 1.0);
  EXPECT_EQ(mcnemar_exact(0, 0), 1.0);
  EXPECT_LT(mcnemar_exact(2000, 1000), 1e-60) << "no overflow";
}

// The example of Wikipedia's article on Spearman's coefficient: -29 / 165.
TEST(Statistics, RankCorrelationIsAsPublished) {
  const std::vector<double> iq{106, 100, 86, 101, 99, 103, 97, 113, 112, 110},
      hours{7, 27, 2, 50, 28, 29, 20, 12, 6, 17};
  EXPECT_NEAR(rank_correlation(iq, hours), -29.0 / 165.0, 1e-12);
  EXPECT_NEAR(rank_correlation({1, 2, 2, 3}, {1, 2, 2, 3}), 1.0, 1e-12) << "equal values";
  EXPECT_TRUE(std::isnan(rank_correlation({1, 1}, {1, 2})));
}

TEST(Statistics, QuantilesAreBetweenTheTwoValuesAroundThem) {
  EXPECT_EQ(quantile_of_sorted({1, 2, 4, 8}, 0.5), 3.0) << "the mean of the two in the middle";
  EXPECT_EQ(quantile_of_sorted({1, 2, 4}, 0.5), 2.0);
  EXPECT_EQ(quantile_of_sorted({1, 2, 4, 8, 16}, 0.0), 1.0);
  EXPECT_EQ(quantile_of_sorted({1, 2, 4, 8, 16}, 1.0), 16.0);
  EXPECT_NEAR(quantile_of_sorted({1, 2, 4, 8, 16}, 0.05), 1.2, 1e-12);
  EXPECT_EQ(quantile_of_sorted({7}, 0.05), 7.0);
  EXPECT_TRUE(std::isnan(quantile_of_sorted({}, 0.5)));
}

TEST(Statistics, TheIntervalAfterAFailureIsThatOfInverseSampling) {
  const Interval tenth = inverse_interval(1, 10);  // (1 - p)^10 = 0.975, (1 - p)^9 = 0.025
  EXPECT_NEAR(tenth.high, std::pow(0.975, 0.1), 1e-12);
  EXPECT_NEAR(tenth.low, std::pow(0.025, 1.0 / 9.0), 1e-12);
  EXPECT_EQ(inverse_interval(4, 4).low, 0.0);
  EXPECT_NEAR(inverse_interval(4, 4).high, 1.0 - std::pow(0.025, 0.25), 1e-12);
  // the number of cases is n with the probability C(n - 1, k - 1) p^k (1 - p)^(n - k)
  for (const double p : {0.02, 0.2, 0.5, 0.9})
    for (const int k : {1, 3, 10}) {
      double covered = 0.0, estimate = 0.0;
      for (int n = k; n < 3000; ++n) {
        const double probability = std::exp(std::lgamma(n) - std::lgamma(k) - std::lgamma(n - k + 1) + k * std::log(p) +
                                            (n - k) * std::log1p(-p));
        if (probability < 1e-15) continue;
        const Interval interval = inverse_interval(k, n);
        if (interval.low <= 1.0 - p && 1.0 - p <= interval.high) covered += probability;
        CampaignSummary summary;
        summary.cases = n;
        summary.verdicts[0] = n - k;
        summary.until_failures = k;
        if (k > 1) estimate += probability * summary.share();
      }
      EXPECT_GE(covered, 0.95 - 1e-9) << p << " " << k;
      if (k > 1) {
        EXPECT_NEAR(estimate, 1.0 - p, 1e-6) << "unbiased";
      }
    }
}

TEST(Statistics, CramersVIsThatOfTheTableOfCounts) {
  EXPECT_NEAR(cramers_v({{20, 10}, {10, 20}}), 1.0 / 3.0, 1e-12) << "(ad - bc) / sqrt((a+b)(c+d)(a+c)(b+d))";
  EXPECT_NEAR(cramers_v({{10, 0}, {0, 10}, {5, 5}}), std::sqrt(20.0 / 30.0), 1e-12);
  EXPECT_EQ(cramers_v({{10, 0}, {0, 10}}), 1.0);
  EXPECT_EQ(cramers_v({{0, 10}, {10, 0}, {0, 0}}), 1.0) << "neither an order nor a word without cases has an effect";
  EXPECT_EQ(cramers_v({{5, 5}, {5, 5}}), 0.0);
  EXPECT_TRUE(std::isnan(cramers_v({{5, 5}, {0, 0}})));
  EXPECT_TRUE(std::isnan(cramers_v({{5, 0}, {5, 0}})));
  EXPECT_TRUE(std::isnan(cramers_v({})));
}

TEST(ResultLines, KeepAllOfAResult) {
  CaseResult result;
  result.number = 17;
  result.verdict = CaseVerdict::violated;
  result.sentence = "expected \"x\"\nabove 1";
  result.reason = "x above 1";
  result.tick = 12;
  result.hash = "0123456789abcdef";
  result.ticks = 20;
  result.margins = {0.1, std::nullopt, -1e-17};
  result.errors = 2;
  result.first_error = "Arm/Swing: wrote nan";
  result.again = true;
  const auto read = result_of_line(line_of(result));
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->repeats(result));
  EXPECT_EQ(read->number, 17);
  EXPECT_EQ(read->reason, "x above 1");
  EXPECT_EQ(read->errors, 2);
  EXPECT_EQ(read->first_error, "Arm/Swing: wrote nan");
  EXPECT_TRUE(read->again);
  EXPECT_FALSE(result_of_line(line_of(result).substr(0, 60)));
  EXPECT_FALSE(result_of_line("{}"));
}

TEST(ResultLines, AfterACutOneAreAppendedToAWholeLine) {
  const auto file = write_file("results.jsonl", "");
  CaseResult result;
  {
    auto opened = ResultFile::open(file);
    ASSERT_TRUE(opened);
    ASSERT_TRUE(opened->append(result));
    EXPECT_FALSE(ResultFile::open(file)) << "it is in use";
  }
  const std::string whole = read_file(file);
  std::ofstream(file, std::ios::app) << R"({"case":1,"ver)";
  auto again = ResultFile::open(file);
  ASSERT_TRUE(again);
  EXPECT_EQ(read_file(file), whole);
}

TEST(Reasons, HaveNoNumbers) {
  EXPECT_EQ(without_numbers("controller 'Arm2/Swing' threw x in control() at tick 120 (0.12 s)"),
            "controller 'Arm2/Swing' threw x in control() at tick # (# s)");
  EXPECT_EQ(without_numbers("it is 1.5e-07 m and -3."), "it is # m and -#.");
}

TEST(ErrorLines, BeginWithTheWord) {
  for (const char* line : {"error: no map", "Error no map", "[ERROR] [12.3] no map", "  error"})
    EXPECT_TRUE(is_error_line(line)) << line;
  for (const char* line : {"", "tracking error: 0.01", "no errors", "errors: 0", "error_norm 0.1", "1.5"})
    EXPECT_FALSE(is_error_line(line)) << line;
}

TEST(Csv, CellsAreReadAsTheyAreWritten) {
  for (const std::string text : {"plain", "a,b", "say \"no\"", ""})
    EXPECT_EQ(csv_cells(csv_cell(text) + ",x"), (std::vector<std::string>{text, "x"}));
}

}  // namespace
}  // namespace rehearse
