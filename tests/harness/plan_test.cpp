// Sobol's sequence and Latin hypercubes as plans of campaigns.
#include "base/text.h"
#include "campaigns/plan/case_values.h"
#include "campaigns/plan/plan_points.h"
#include "scenario_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> some_names(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back("p" + std::to_string(i));
  return names;
}

PlanPoints plan(PlanKind kind, std::size_t parameters, std::int64_t cases, std::uint64_t seed = 3) {
  return PlanPoints(kind, seed, some_names(parameters), cases);
}

TEST(SobolPlan, HasACaseInEachPartOfEachParameter) {
  const PlanPoints points = plan(PlanKind::sobol, PlanPoints::most_sobol_parameters, 4096);
  for (std::size_t parameter = 0; parameter < PlanPoints::most_sobol_parameters; ++parameter)
    for (const std::int64_t parts : {2, 16, 256, 1024})
      for (const std::int64_t first : {std::int64_t{0}, parts, 3 * parts}) {
        std::set<std::int64_t> visited;
        for (std::int64_t number = first; number < first + parts; ++number)
          visited.insert(static_cast<std::int64_t>(points.at(parameter, number) * static_cast<double>(parts)));
        ASSERT_EQ(static_cast<std::int64_t>(visited.size()), parts) << "parameter " << parameter << " from " << first;
      }
}

/// The largest t for which some cell of volume 2^(t - m) has another number of the first 2^m cases than 2^t.
int quality(const PlanPoints& points, std::size_t a, std::size_t b, int m) {
  for (int t = 0; t <= m; ++t) {
    bool all = true;
    for (int of_a = 0; of_a <= m - t && all; ++of_a) {
      const int of_b = m - t - of_a;
      std::vector<int> counts(std::size_t{1} << (m - t));
      for (std::int64_t number = 0; number < (1 << m); ++number) {
        const auto x = static_cast<std::size_t>(points.at(a, number) * (1 << of_a));
        const auto y = static_cast<std::size_t>(points.at(b, number) * (1 << of_b));
        ++counts[(x << of_b) + y];
      }
      all = std::ranges::all_of(counts, [&](int count) { return count == 1 << t; });
    }
    if (all) return t;
  }
  return m;
}

// The first two parameters are a (0, 2)-sequence; others have a larger t, which the direction numbers keep small.
TEST(SobolPlan, FillsPairsOfParametersEvenly) {
  const PlanPoints points = plan(PlanKind::sobol, PlanPoints::most_sobol_parameters, 256);
  EXPECT_EQ(quality(points, 0, 1, 8), 0);
  for (std::size_t b = 1; b < PlanPoints::most_sobol_parameters; ++b)
    for (std::size_t a = 0; a < b; ++a) EXPECT_LE(quality(points, a, b, 8), 5) << a << " and " << b;
}

TEST(SobolPlan, KeepsItsCasesIfTheirNumberGrowsOrAParameterIsAdded) {
  const PlanPoints few = plan(PlanKind::sobol, 3, 10), many = plan(PlanKind::sobol, 5, 1000);
  const PlanPoints other = plan(PlanKind::sobol, 3, 10, 4);
  for (std::int64_t number = 0; number < 10; ++number)
    for (std::size_t parameter = 0; parameter < 3; ++parameter) {
      EXPECT_EQ(few.at(parameter, number), many.at(parameter, number));
      EXPECT_NE(few.at(parameter, number), other.at(parameter, number)) << "another seed";
    }
}

TEST(LatinPlan, HasOneCaseInEachPartOfEachParameter) {
  for (const std::int64_t cases : {1, 2, 7, 1000}) {
    const PlanPoints points = plan(PlanKind::latin_hypercube, 3, cases);
    for (std::size_t parameter = 0; parameter < 3; ++parameter) {
      std::set<std::int64_t> visited;
      for (std::int64_t number = 0; number < cases; ++number) {
        const double at = points.at(parameter, number);
        EXPECT_GT(at, 0.0);
        EXPECT_LT(at, 1.0);
        visited.insert(static_cast<std::int64_t>(at * static_cast<double>(cases)));
      }
      EXPECT_EQ(static_cast<std::int64_t>(visited.size()), cases);
    }
  }
}

TEST(LatinPlan, OrdersEachParameterIndependently) {
  constexpr std::int64_t cases = 4000;
  const PlanPoints points = plan(PlanKind::latin_hypercube, 2, cases);
  double covariance = 0.0;
  for (std::int64_t number = 0; number < cases; ++number)
    covariance += (points.at(0, number) - 0.5) * (points.at(1, number) - 0.5) / cases;
  EXPECT_LT(std::abs(12.0 * covariance), 3.0 / std::sqrt(cases));
}

/// The root of the mean squared error, over 50 seeds, of the mean of f over the cases of a plan, whose integral is 1.
template <class Function>
double error_of(PlanKind kind, Function f) {
  constexpr std::int64_t cases = 256;
  constexpr int seeds = 50;
  double squares = 0.0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const PlanPoints points = plan(kind, 3, cases, seed);
    double mean = 0.0;
    for (std::int64_t number = 0; number < cases; ++number)
      mean += f(points.at(0, number), points.at(1, number), points.at(2, number)) / cases;
    squares += (mean - 1.0) * (mean - 1.0) / seeds;
  }
  return std::sqrt(squares);
}

// The integral of the product of 2 x, and that of the sum of 2/3 x, is 1. The standard deviation of the product is
// sqrt((4/3)^3 - 1), and that of the sum 1/3: independent cases have these over the root of their number.
TEST(Plans, IntegrateBetterThanIndependentCases) {
  const auto product = [](double x, double y, double z) { return 8.0 * x * y * z; };
  const auto sum = [](double x, double y, double z) { return 2.0 / 3.0 * (x + y + z); };
  const double of_product = std::sqrt(std::pow(4.0 / 3.0, 3.0) - 1.0) / 16.0, of_sum = 1.0 / 3.0 / 16.0;
  EXPECT_NEAR(error_of(PlanKind::random, product), of_product, 0.3 * of_product);
  EXPECT_NEAR(error_of(PlanKind::random, sum), of_sum, 0.3 * of_sum);
  EXPECT_LT(error_of(PlanKind::sobol, product), 0.1 * of_product);
  EXPECT_LT(error_of(PlanKind::sobol, sum), 0.1 * of_sum);
  EXPECT_LT(error_of(PlanKind::latin_hypercube, product), 0.6 * of_product) << "what isn't additive remains";
  EXPECT_LT(error_of(PlanKind::latin_hypercube, sum), 0.02 * of_sum);
}

const std::string pushed_box =
    "rehearse: 1\nduration: 1\nbodies:\n  - {name: Box, box: {size: [1, 1, 1]}, mass: 2, position: [0, 0, 1]}\n"
    "pushes:\n  - {body: Box, force: [1, 2, 3], from: 0.1, until: 0.2}\n";
const std::string varied_mass = "vary:\n  mass: {path: bodies.Box.mass, uniform: [1, 3]}\n";

TEST(Plans, AreAKeyOfTheScenario) {
  const auto first_values = [](const std::string& plan) {
    const auto made = CaseValues::make(loaded(pushed_box + plan + varied_mass), 5, 100);
    EXPECT_TRUE(made.ok());
    return made ? (*made)->of(0)[0] + ' ' + (*made)->of(1)[0] : std::string();
  };
  const std::string random = first_values("");
  EXPECT_EQ(first_values("plan: random\n"), random);
  EXPECT_NE(first_values("plan: sobol\n"), random);
  EXPECT_NE(first_values("plan: latin_hypercube\n"), random);
  EXPECT_NE(first_values("plan: latin_hypercube\n"), first_values("plan: sobol\n"));
}

TEST(Plans, FillTheDistributionsOfTheScenario) {
  const auto made = CaseValues::make(loaded(pushed_box + "plan: latin_hypercube\n" + varied_mass +
                                            "  push: {path: \"pushes[0].force[0]\", choice: [5, 6, 7]}\n"),
                                     0, 300);
  ASSERT_TRUE(made.ok());
  std::set<int> parts;
  int sixes = 0;
  for (std::int64_t number = 0; number < 300; ++number) {
    const std::vector<std::string> values = (*made)->of(number);
    parts.insert(static_cast<int>((*number_in<double>(values[0]) - 1.0) * 150.0));
    sixes += values[1] == "6" ? 1 : 0;
  }
  EXPECT_EQ(parts.size(), 300u);
  EXPECT_EQ(sixes, 100) << "a choice is made of equal parts";
}

TEST(Plans, HaveTheirLimits) {
  const auto refused = [](const std::string& text, std::int64_t cases) {
    const auto made = CaseValues::make(loaded(text), 0, cases);
    EXPECT_FALSE(made.ok());
    return made ? std::string() : to_string(made.errors());
  };
  EXPECT_THAT(refused(pushed_box + "plan: latin_hypercube\n" + varied_mass, 1'000'001),
              HasSubstr("a Latin hypercube of 1000001 cases is too large; it has at most 1000000"));
  std::string many = pushed_box;
  many.replace(many.find("pushes:"), std::string::npos, "pushes:\n");
  for (int i = 0; i < 8; ++i) many += "  - {body: Box, force: [1, 2, 3], from: 0.1, until: 0.2}\n";
  many += "plan: sobol\nvary:\n";
  for (int i = 0; i < 22; ++i)
    many += "  p" + std::to_string(i) + ": {path: \"pushes[" + std::to_string(i / 3) + "].force[" +
            std::to_string(i % 3) + "]\", uniform: [0, 1]}\n";
  EXPECT_THAT(refused(many, 10), HasSubstr("'p21' is one parameter too many for Sobol's sequence, which has 21 here"));
  EXPECT_TRUE(CaseValues::make(loaded(many.erase(many.find("  p21:"))), 0, 10).ok());
}

}  // namespace
}  // namespace rehearse
