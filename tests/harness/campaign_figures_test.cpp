// How often claims of campaigns are wrong, and whether searches find failures of known probabilities. At night with all
// rows and seeds of the tables that are printed.
#include "campaigns/plan/case_values.h"
#include "campaigns/shrink/likelihood_ratio.h"
#include "campaigns/shrink/steering.h"
#include "campaigns/statistics/binomial.h"
#include "scenario_files.h"

#include <rehearse/campaign_report.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "support/made_up.h"

namespace rehearse {
namespace {

constexpr bool at_night = AT_NIGHT;

double probability_of(std::int64_t passed, std::int64_t all, double rate) {
  const double some = static_cast<double>(passed), n = static_cast<double>(all);
  return std::exp(std::lgamma(n + 1.0) - std::lgamma(some + 1.0) - std::lgamma(n - some + 1.0) + some * std::log(rate) +
                  (n - some) * std::log1p(-rate));
}

/// By all outcomes: the probability that a claim is called true or false although the rate is exactly its bound. Any
/// other rate for which the answer is wrong has a smaller one.
TEST(PassRate, IsAnsweredWronglyAsSeldomAsItSays) {
  const std::vector<std::int64_t> numbers = at_night ? std::vector<std::int64_t>{5, 10, 17, 20, 50, 100, 200, 500, 1000}
                                                     : std::vector<std::int64_t>{5, 17, 100, 1000};
  std::printf("| cases | rate | said to be false | said to be true |\n| --- | --- | --- | --- |\n");
  double most = 0.0;
  for (const std::int64_t n : numbers) {
    for (const double rate : {0.5, 0.8, 0.9, 0.95, 0.99, 0.999}) {
      const ClaimedRate claim{rate, 0.95};
      double passes = 0.0, fails = 0.0;
      for (std::int64_t passed = 0; passed <= n; ++passed) {
        const ClaimAnswer answer = answer_of(claim, exact_interval(passed, n));
        (answer == ClaimAnswer::passes ? passes : fails) +=
            answer == ClaimAnswer::undecided ? 0.0 : probability_of(passed, n, rate);
      }
      std::printf("| %d | %g | %.2f %% | %.2f %% |\n", static_cast<int>(n), rate, 100.0 * fails, 100.0 * passes);
      EXPECT_LE(fails, 0.025) << n << " cases, rate " << rate;
      EXPECT_LE(passes, 0.025) << n << " cases, rate " << rate;
      most = std::max({most, fails, passes});
    }
  }
  EXPECT_GT(most, 0.015) << "the test can find an error";
}

TEST(Binomial, ProbabilitiesAreSumsOfThoseOfTheNumbers) {
  for (const std::int64_t n : {1, 7, 40})
    for (std::int64_t k = 0; k <= n; ++k) {
      double sum = 0.0;
      for (std::int64_t i = 0; i <= k; ++i) sum += probability_of(i, n, 0.3);
      const double some = static_cast<double>(k), all = static_cast<double>(n);
      EXPECT_NEAR(binomial_at_most(some, all, 0.3), sum, 1e-12);
      EXPECT_NEAR(binomial_at_least(some + 1.0, all, 0.3), 1.0 - sum, 1e-12);
      if (k < n) {
        EXPECT_NEAR(binomial_at_most(some, all, binomial_upper_bound(some, all, 0.025)), 0.025, 1e-12);
      }
      if (k > 0) {
        EXPECT_NEAR(binomial_at_least(some, all, binomial_lower_bound(some, all, 0.025)), 0.025, 1e-12);
      }
    }
}

// Searches. A case of a made-up campaign has a margin by a formula; values, steering and estimate are those of real
// ones.

struct MadeUpSearch {
  std::vector<std::string> parameters;  // the distribution of each, as in `vary`
  std::function<double(const std::vector<double>&)> margin;
};

// Of standard normal distributions: the probabilities beyond these numbers are 1e-1, 1e-2, 1e-4 and 1e-6.
constexpr double one_in_10 = 1.2815515655446004, one_in_100 = 2.3263478740408408, one_in_10_000 = 3.7190164854556804,
                 one_in_a_million = 4.753424308822899;

const char* const standard_normal = "normal: {mean: 0, stddev: 1, from: -9, to: 9}";

/// Fails beyond so many deviations of the first parameter, or of the sum of all.
MadeUpSearch beyond(double deviations, std::size_t parameters) {
  const double scale = std::sqrt(static_cast<double>(parameters));
  return {std::vector<std::string>(parameters, standard_normal), [=](const std::vector<double>& values) {
            double sum = 0.0;
            for (const double value : values) sum += value;
            return deviations - sum / scale;
          }};
}

class Searching {
 public:
  Searching(const MadeUpSearch& made_up, std::uint64_t seed) : made_up_(made_up), seed_(seed) {
    std::string text =
        "rehearse: 1\nduration: 1\nbodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 2, position: [0, 0, 1]}\n"
        "pushes:\n  - {body: Box, force: [1, 2, 3], from: 0.1, until: 0.2}\n"
        "  - {body: Box, force: [1, 2, 3], from: 0.3, until: 0.4}\n"
        "  - {body: Box, force: [1, 2, 3], from: 0.5, until: 0.6}\nvary:\n";
    for (std::size_t i = 0; i < made_up.parameters.size(); ++i)
      text += "  p" + std::to_string(i) + ": {path: \"pushes[" + std::to_string(i / 3) + "].force[" +
              std::to_string(i % 3) + "]\", " + made_up.parameters[i] + "}\n";
    scenario_ = loaded(text);
  }

  /// The number of rounds until a case fails; 0: none does in six rounds of 50 cases.
  int rounds() {
    for (int round = 1; round <= 6; ++round) {
      const auto [values, margins] = cases(50, 0.0);
      std::vector<SteeredParameter> next;
      const std::vector<std::size_t> elite = elite_of(margins);
      for (std::size_t i = 0; i < values.size(); ++i) {
        std::vector<double> of_elite;
        for (const std::size_t number : elite) of_elite.push_back(values[i][number]);
        next.push_back(steered_by(scenario_.variations[i], steered_, of_elite));
      }
      steered_ = next;
      ++seed_;
      if (std::ranges::any_of(margins, [](double margin) { return margin < 0.0; })) return round;
    }
    return 0;
  }

  FailureProbability estimate(std::int64_t count) {
    const auto [values, margins] = cases(count, 0.2);
    return failure_probability(scenario_.variations, {steered_, 0.2}, values, margins);
  }

 private:
  struct Cases {
    std::vector<std::vector<double>> values;  // by parameter, by case
    std::vector<double> margins;
  };

  Cases cases(std::int64_t count, double own_share) const {
    const auto drawn = CaseValues::make(scenario_, seed_, count, {steered_, own_share});
    Cases made{std::vector<std::vector<double>>(made_up_.parameters.size()), {}};
    for (std::int64_t number = 0; number < count; ++number) {
      std::vector<double> values;
      for (const std::string& text : (*drawn)->of(number)) values.push_back(std::stod(text));
      for (std::size_t i = 0; i < values.size(); ++i) made.values[i].push_back(values[i]);
      made.margins.push_back(made_up_.margin(values));
    }
    return made;
  }

  const MadeUpSearch& made_up_;
  std::uint64_t seed_;
  Scenario scenario_;
  std::vector<SteeredParameter> steered_;
};

TEST(Search, FindsFailuresAtTwoToFiveDeviations) {
  constexpr int seeds = 20;
  std::printf("| deviations | parameters | found | rounds |\n| --- | --- | --- | --- |\n");
  for (const double deviations : {2.0, 3.0, 4.0, 5.0})
    for (const std::size_t parameters : {std::size_t{1}, std::size_t{3}}) {
      int found = 0, most = 0;
      const MadeUpSearch search = beyond(deviations, parameters);
      for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const int rounds = Searching(search, 1000 * seed).rounds();
        found += rounds > 0;
        most = std::max(most, rounds);
      }
      std::printf("| %g | %d | %d of %d | %d |\n", deviations, static_cast<int>(parameters), found, seeds, most);
      EXPECT_GE(found, 19) << deviations << " deviations, " << parameters << " parameters";
    }
}

/// A window within a range, a hundredth of it, is surrounded by the elite: the deviation shrinks.
TEST(Search, FindsAWindowWithinARange) {
  const MadeUpSearch window{{"uniform: [0, 1]"},
                            [](const std::vector<double>& values) { return std::abs(values[0] - 0.3) - 5e-4; }};
  int found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) found += Searching(window, 1000 * seed).rounds() > 0;
  EXPECT_GE(found, 19);
}

TEST(FailureProbability, IsWithinItsIntervalAsOftenAsItSays) {
  const int seeds = at_night ? 200 : 50;
  const struct {
    const char* what;
    double probability;
    MadeUpSearch search;
    std::int64_t cases = 300;
  } rows[] = {
      {"1 normal parameter", 1e-1, beyond(one_in_10, 1)},
      {"1 normal parameter", 1e-2, beyond(one_in_100, 1)},
      {"1 normal parameter", 1e-4, beyond(one_in_10_000, 1)},
      {"1 normal parameter", 1e-6, beyond(one_in_a_million, 1)},
      {"the sum of 3 normal ones", 1e-1, beyond(one_in_10, 3)},
      {"the sum of 3 normal ones", 1e-2, beyond(one_in_100, 3)},
      {"the sum of 3 normal ones", 1e-4, beyond(one_in_10_000, 3)},
      {"the sum of 3 normal ones", 1e-6, beyond(one_in_a_million, 3)},
      {"the sum of 5 normal ones", 1e-6, beyond(one_in_a_million, 5)},
      {"the end of a uniform one, beside another",
       1e-1,
       {{"uniform: [0, 1]", "uniform: [0, 1]"}, [](const std::vector<double>& values) { return values[0] - 0.1; }}},
      {"the end of a uniform one, beside another",
       1e-3,
       {{"uniform: [0, 1]", "uniform: [0, 1]"}, [](const std::vector<double>& values) { return values[0] - 1e-3; }}},
      {"the end of a log_uniform one",
       1e-2,
       {{"log_uniform: [1, 10000]"}, [](const std::vector<double>& values) { return 9120.1083935590974 - values[0]; }}},
      {"the sum of 3 normal ones", 1e-6, beyond(one_in_a_million, 3), 40},
      {"the sum of 5 normal ones", 1e-6, beyond(one_in_a_million, 5), 100},
      {"the sum of 8 normal ones", 1e-4, beyond(one_in_10_000, 8), 100},
      {"the sum of 8 normal ones", 1e-6, beyond(one_in_a_million, 8), 300},
  };
  std::printf(
      "| fails beyond a value of | probability | cases | its interval has it | not enough fail | violations, median |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const auto& row : rows) {
    int within = 0, too_few = 0;
    std::vector<std::int64_t> violations;
    for (int seed = 0; seed < seeds; ++seed) {
      Searching search(row.search, 1000 * static_cast<std::uint64_t>(seed));
      search.rounds();
      const FailureProbability found = search.estimate(row.cases);
      violations.push_back(found.violations);
      too_few += found.has_enough_violations ? 0 : 1;
      within += found.interval.low <= row.probability && row.probability <= found.interval.high;
    }
    std::ranges::sort(violations);
    std::printf("| %s | %g | %d | %d of %d | %d | %d |\n", row.what, row.probability, static_cast<int>(row.cases),
                within, seeds, too_few, static_cast<int>(violations[violations.size() / 2]));
    EXPECT_GT(test::binomial_at_least(seeds - within, seeds, 0.05), 0.001)
        << row.what << ", " << row.probability << ", " << row.cases << " cases: " << within;
  }
}

}  // namespace
}  // namespace rehearse
