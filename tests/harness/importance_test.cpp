// Variance-based importance, and probabilities of failures from steered cases, against closed forms.
#include "campaigns/plan/case_values.h"
#include "campaigns/shrink/likelihood_ratio.h"

#include <rehearse/campaign_report.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "support/made_up.h"

namespace rehearse {
namespace {

/// Column `name` of n random numbers from low to high.
std::vector<double> random_column(const std::string& name, std::int64_t n, double low, double high) {
  std::vector<double> column;
  for (std::int64_t i = 0; i < n; ++i) column.push_back(low + (high - low) * uniform_number(11, i, name));
  return column;
}

double share_of(const std::vector<double>& inputs, const std::vector<double>& outputs) {
  return first_order_index(inputs, outputs).value().share;
}

// T. Ishigami, T. Homma (1990): sin x + 7 sin² y + 0.1 z⁴ sin x, from -pi to pi. With a = 7 and b = 0.1 the variance is
// a²/8 + b pi⁴/5 + b² pi⁸/18 + 1/2, that of x alone (1 + b pi⁴/5)²/2, that of y alone a²/8, that of z alone 0.
TEST(Importance, IsThatOfTheIshigamiFunction) {
  constexpr std::int64_t n = 20'000;
  constexpr double pi = std::numbers::pi;
  const auto x = random_column("x", n, -pi, pi), y = random_column("y", n, -pi, pi), z = random_column("z", n, -pi, pi);
  std::vector<double> outputs;
  for (std::size_t i = 0; i < x.size(); ++i)
    outputs.push_back(std::sin(x[i]) + 7.0 * std::sin(y[i]) * std::sin(y[i]) +
                      0.1 * std::pow(z[i], 4) * std::sin(x[i]));
  const double b = 0.1 * std::pow(pi, 4) / 5.0;
  const double all = 49.0 / 8.0 + b + 0.01 * std::pow(pi, 8) / 18.0 + 0.5;
  EXPECT_NEAR(share_of(x, outputs), 0.5 * (1.0 + b) * (1.0 + b) / all, 0.02);  // 0.3139
  EXPECT_NEAR(share_of(y, outputs), 49.0 / 8.0 / all, 0.02);                   // 0.4424
  EXPECT_NEAR(share_of(z, outputs), 0.0, 0.02);
}

TEST(Importance, IsTheShareOfASum) {
  constexpr std::int64_t n = 5000;
  const auto x = random_column("x", n, 0, 1), y = random_column("y", n, 0, 1), z = random_column("z", n, 0, 1);
  std::vector<double> outputs;
  for (std::size_t i = 0; i < x.size(); ++i) outputs.push_back(3.0 * x[i] - 2.0 * y[i] + z[i]);
  EXPECT_NEAR(share_of(x, outputs), 9.0 / 14.0, 0.02);
  EXPECT_NEAR(share_of(y, outputs), 4.0 / 14.0, 0.03);
  EXPECT_NEAR(share_of(z, outputs), 1.0 / 14.0, 0.03);
}

// a half passes if both are above or both below: neither matters alone
TEST(Importance, IsNoneOfParametersThatMatterOnlyTogether) {
  constexpr std::int64_t n = 5000;
  const auto x = random_column("x", n, -1, 1), y = random_column("y", n, -1, 1);
  std::vector<double> passing;
  for (std::size_t i = 0; i < x.size(); ++i) passing.push_back(x[i] * y[i] > 0.0 ? 1.0 : 0.0);
  EXPECT_LT(share_of(x, passing), 0.02);
  EXPECT_LT(share_of(y, passing), 0.02);
}

// A sum of a parameter and noise: the parameter explains 1/2. Six parts leave 1/36 of it within them. Without a
// correction the estimate would be larger by about (6 - 1) / (40 - 1) of the rest.
TEST(Importance, HasNoBiasInFewCases) {
  constexpr int campaigns = 400, n = 40;
  double mean = 0.0;
  for (int campaign = 0; campaign < campaigns; ++campaign) {
    const auto x = random_column("x" + std::to_string(campaign), n, 0, 1);
    const auto noise = random_column("noise" + std::to_string(campaign), n, 0, 1);
    std::vector<double> outputs;
    for (std::size_t i = 0; i < x.size(); ++i) outputs.push_back(x[i] + noise[i]);
    mean += share_of(x, outputs) / campaigns;
  }
  EXPECT_NEAR(mean, 0.5 * (1.0 - 1.0 / 36.0), 0.02);
}

TEST(Importance, OfWordsIsThatOfTheirMeans) {
  // two words, with the means 1 and 3 and the variance 1 within each: 1 of 2 is explained
  std::vector<double> words, outputs;
  for (int i = 0; i < 400; ++i) {
    words.push_back(i % 2);
    outputs.push_back((i % 2 == 0 ? 1.0 : 3.0) + (i / 2 % 2 == 0 ? 1.0 : -1.0));
  }
  EXPECT_NEAR(share_of(words, outputs), 0.5, 0.002);
}

TEST(Importance, IsUnknownWithoutVariance) {
  EXPECT_FALSE(first_order_index({1, 2, 3, 4}, {5, 5, 5, 5}));
  EXPECT_FALSE(first_order_index({}, {}));
  EXPECT_FALSE(first_order_index({1}, {2}));
}

/// Below the threshold all fail and above it all pass, so the parameter decides alone. Parts of the inputs lie on both
/// sides of it, so that the share is below 1.
TEST(Importance, OfAThresholdHasOneHundredPercentInItsInterval) {
  int within = 0;
  double least = 1.0;
  constexpr int campaigns = 200;
  for (int campaign = 0; campaign < campaigns; ++campaign) {
    const auto x = random_column("x" + std::to_string(campaign), 60, 0, 1);
    std::vector<double> passing;
    for (const double value : x) passing.push_back(value > 0.3 ? 1.0 : 0.0);
    const auto found = first_order_index(x, passing);
    ASSERT_TRUE(found);
    within += found->interval.high >= 0.999;
    least = std::min(least, found->share);
  }
  std::printf("| a threshold, 60 cases | 100 %% is within %d of %d intervals; the least share is %.0f %% |\n", within,
              campaigns, 100.0 * least);
  EXPECT_LT(least, 0.85);
  EXPECT_GT(test::binomial_at_least(campaigns - within, campaigns, 0.05), 0.001);
}

/// A few failures look like noise to the differences between neighbours, though thresholds explain them.
TEST(Importance, OfThresholdsHasOneHundredPercentInItsIntervalThoughFewCasesFail) {
  const struct {
    const char* what;
    std::function<bool(double, double)> fails;  // a number, 0 to 1, of which this share fails
  } rows[] = {
      {"below a threshold", [](double value, double share) { return value < share; }},
      {"at both ends", [](double value, double share) { return std::abs(value - 0.5) > 0.5 - 0.5 * share; }},
      {"in the middle", [](double value, double share) { return std::abs(value - 0.5) < 0.5 * share; }},
  };
  const int campaigns = AT_NIGHT ? 400 : 50;
  std::printf("| fails | cases | share that fails | 100 %% is within |\n| --- | --- | --- | --- |\n");
  for (const auto& row : rows)
    for (const std::int64_t n : {16, 60, 200})
      for (const double share : {0.03, 0.1, 0.3}) {
        int within = 0, all = 0;
        for (int campaign = 0; campaign < campaigns; ++campaign) {
          const auto x = random_column("x" + std::to_string(campaign), n, 0, 1);
          std::vector<double> passing;
          for (const double value : x) passing.push_back(row.fails(value, share) ? 0.0 : 1.0);
          const auto found = first_order_index(x, passing);  // none: all pass
          all += found ? 1 : 0;
          within += found && found->interval.high >= 0.999 ? 1 : 0;
        }
        std::printf("| %s | %d | %g %% | %d of %d |\n", row.what, static_cast<int>(n), 100.0 * share, within, all);
        EXPECT_GT(test::binomial_at_least(all - within, all, 0.05), 0.001)
            << row.what << ", " << n << " cases, " << share;
      }
}

/// Of 80 % on one side of the threshold, and of 10 % on the other.
TEST(Importance, OfAThresholdBesideChanceIsWithinItsIntervalAsOftenAsItSays) {
  const int campaigns = AT_NIGHT ? 400 : 100;
  for (const std::int64_t n : {60, 200, 1000})
    for (const double share : {0.3, 0.5}) {
      const double mean = 0.8 * share + 0.1 * (1.0 - share);
      const double explained = 0.7 * 0.7 * share * (1.0 - share) / (mean * (1.0 - mean));
      int missed = 0;
      for (int campaign = 0; campaign < campaigns; ++campaign) {
        const auto x = random_column("x" + std::to_string(campaign), n, 0, 1);
        const auto chance = random_column("chance" + std::to_string(campaign), n, 0, 1);
        std::vector<double> passing;
        for (std::size_t i = 0; i < x.size(); ++i)
          passing.push_back(chance[i] < (x[i] < share ? 0.8 : 0.1) ? 0.0 : 1.0);
        const Interval interval = first_order_index(x, passing)->interval;
        missed += interval.low > explained || interval.high < explained;
      }
      std::printf("| a threshold at %g and chance, %d cases | %.0f %% is outside %d of %d intervals |\n", share,
                  static_cast<int>(n), 100.0 * explained, missed, campaigns);
      EXPECT_GT(test::binomial_at_least(missed, campaigns, 0.05), 0.001) << n << " cases, " << share << ": " << missed;
    }
}

TEST(Importance, IsWithinItsIntervalAsOftenAsItSays) {
  constexpr int campaigns = 400;
  for (const std::int64_t n : {40, 100, 400}) {
    int missed = 0;
    for (int campaign = 0; campaign < campaigns; ++campaign) {
      const auto x = random_column("x" + std::to_string(campaign), n, 0, 1);
      const auto noise = random_column("noise" + std::to_string(campaign), n, 0, 1);
      std::vector<double> outputs;
      for (std::size_t i = 0; i < x.size(); ++i) outputs.push_back(x[i] + noise[i]);
      const Interval interval = first_order_index(x, outputs)->interval;
      missed += interval.low > 0.5 || interval.high < 0.5;
    }
    std::printf("| a parameter and noise, %d cases | 50 %% is outside %d of %d intervals |\n", static_cast<int>(n),
                missed, campaigns);
    EXPECT_GT(test::binomial_at_least(missed, campaigns, 0.05), 0.001) << n << " cases: " << missed;
  }
}

Variation variation(Distribution distribution, double low, double high, double mean = 0.0, double stddev = 1.0) {
  Variation made;
  made.distribution = distribution;
  made.low = low;
  made.high = high;
  made.mean = mean;
  made.stddev = stddev;
  return made;
}

TEST(Densities, HaveTheIntegralOne) {
  for (const Variation& of :
       {variation(Distribution::uniform, -2, 5), variation(Distribution::log_uniform, 0.1, 10),
        variation(Distribution::normal, -1, 3, 0.5, 0.8), variation(Distribution::normal, 4, 6, 0, 1)}) {
    constexpr int steps = 200'000;
    const double step = (of.high - of.low) / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) sum += step * density_of(of, of.low + (i + 0.5) * step);
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_EQ(density_of(of, of.low - 0.01), 0.0);
    EXPECT_EQ(density_of(of, of.high + 0.01), 0.0);
  }
}

TEST(Densities, AreThoseOfTheQuantiles) {
  const Variation of = variation(Distribution::normal, -1, 3, 0.5, 0.8);
  for (const double share : {0.1, 0.5, 0.9}) {
    const double step = 1e-5, width = quantile_of(of, share + step) - quantile_of(of, share - step);
    EXPECT_NEAR(density_of(of, quantile_of(of, share)), 2.0 * step / width, 1e-6);
  }
}

constexpr double own_share = 0.2;

/// The estimate of a campaign of n cases of two parameters, of which those fail that `fails` says.
template <class Fails>
FailureProbability estimated(const std::vector<Variation>& own, const std::vector<SteeredVariation>& steered,
                             std::int64_t n, std::uint64_t seed, Fails fails) {
  std::vector<double> ratios;
  for (std::int64_t i = 0; i < n; ++i) {
    std::vector<double> values;
    for (std::size_t parameter = 0; parameter < own.size(); ++parameter) {
      const std::string name = parameter == 0 ? "x" : "y";
      const double random = uniform_number(seed, i, name);
      const bool is_own = uniform_number(seed, i, name + "/own") < own_share;
      values.push_back(is_own ? quantile_of(own[parameter], random) : quantile_of(steered[parameter], random));
    }
    if (fails(values[0], values[1])) ratios.push_back(likelihood_ratio(own, steered, values, own_share));
  }
  return failure_probability(ratios, n, own_share * own_share);
}

/// Compares 200 estimates with the probability: their mean, and how many of their intervals contain it.
template <class Fails>
void compare_with(double probability, const std::vector<Variation>& own, const std::vector<SteeredVariation>& steered,
                  Fails fails) {
  constexpr int campaigns = 200;
  constexpr std::int64_t n = 500;
  double mean = 0.0;
  int within = 0;
  for (std::uint64_t seed = 0; seed < campaigns; ++seed) {
    const FailureProbability found = estimated(own, steered, n, seed, fails);
    mean += found.estimate / campaigns;
    within += found.interval.low <= probability && probability <= found.interval.high ? 1 : 0;
  }
  EXPECT_NEAR(mean / probability, 1.0, 0.05);
  EXPECT_GT(test::binomial_at_least(campaigns - within, campaigns, 0.05), 0.001)
      << within << " of 200 intervals with 95 % confidence";
}

TEST(FailureProbability, OfACornerIsItsArea) {
  const std::vector<Variation> own{variation(Distribution::uniform, 0, 1), variation(Distribution::uniform, 0, 1)};
  compare_with(1e-4, own, {steer(own[0], {"x", 0.0, 0.01}), steer(own[1], {"y", 1.0, 0.01})},
               [](double x, double y) { return x < 0.01 && y > 0.99; });
}

TEST(FailureProbability, OfANormalTailIsItsShare) {
  const std::vector<Variation> own{variation(Distribution::normal, -8, 8), variation(Distribution::uniform, 0, 1)};
  compare_with(3.167124183312e-5, own, {steer(own[0], {"x", 4.2, 0.4}), steer(own[1], {"y", 0.5, 0.5})},
               [](double x, double) { return x > 4.0; });  // Q(4)
}

TEST(FailureProbability, IncludesFailuresToWhichNothingWasSteered) {
  // steered to one end: the other end is found by the cases with the scenario's own distributions
  const std::vector<Variation> own{variation(Distribution::uniform, 0, 1), variation(Distribution::uniform, 0, 1)};
  compare_with(0.11, own, {steer(own[0], {"x", 0.0, 0.01}), steer(own[1], {"y", 0.5, 0.3})},
               [](double x, double) { return x < 0.01 || x > 0.9; });
}

TEST(FailureProbability, OfALogarithmicParameterIsItsShareOfTheLogarithm) {
  const std::vector<Variation> own{variation(Distribution::log_uniform, 1, 1e4),
                                   variation(Distribution::log_uniform, 0.5, 8)};
  compare_with(2.5e-3, own, {steer(own[0], {"x", 0.0, 0.1}), steer(own[1], {"y", std::log(2.0), 0.5})},
               [](double x, double) { return x < std::pow(10.0, 0.01); });
}

TEST(FailureProbability, DoesntMissWhatAParameterThatHasNoSayWasSteeredAwayFrom) {
  const std::vector<Variation> own{variation(Distribution::uniform, 0, 1), variation(Distribution::uniform, 0, 1)};
  compare_with(0.01, own, {steer(own[0], {"x", 0.0, 0.01}), steer(own[1], {"y", 0.8, 0.15})},
               [](double x, double) { return x < 0.01; });
}

TEST(Densities, OfASteeredLogarithmHaveTheIntegralOne) {
  const SteeredVariation steered = steer(variation(Distribution::log_uniform, 0.5, 8), {"x", std::log(2.0), 0.4});
  constexpr int steps = 100'000;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i) sum += density_of(steered, 0.5 + 7.5 * (i + 0.5) / steps) * 7.5 / steps;
  EXPECT_NEAR(sum, 1.0, 1e-6);
}

/// Their weights say too little of weights that didn't occur.
TEST(FailureProbability, OfFewViolationsHasTheUpperBoundOfTheirNumber) {
  std::vector<double> ratios(9, 1e-3);
  const FailureProbability few = failure_probability(ratios, 500, own_share);
  EXPECT_FALSE(few.has_enough_violations);
  EXPECT_DOUBLE_EQ(few.estimate, 9e-3 / 500);
  EXPECT_EQ(few.interval.low, 0.0);
  EXPECT_NEAR(few.interval.high, 0.0339 / own_share, 5e-4) << "Clopper and Pearson: 9 of 500";
  ratios.resize(100, 1e-6);
  EXPECT_FALSE(failure_probability(ratios, 500, own_share).has_enough_violations) << "91 have hardly any weight";
  ratios.assign(100, 1e-3);
  EXPECT_TRUE(failure_probability(ratios, 500, own_share).has_enough_violations);
  EXPECT_EQ(failure_probability({1.0, 1.0}, 2, own_share).interval.high, 1.0) << "all violate";
}

TEST(FailureProbability, WithoutAViolationHasAnUpperBound) {
  const FailureProbability none = failure_probability({}, 500, own_share);
  EXPECT_EQ(none.estimate, 0.0);
  EXPECT_EQ(none.interval.low, 0.0);
  EXPECT_NEAR(std::pow(1.0 - own_share * none.interval.high, 500), 0.025, 1e-12);
  EXPECT_EQ(failure_probability({}, 1, own_share).interval.high, 1.0);
}

}  // namespace
}  // namespace rehearse
