// The guided search of fuzz tests beside random search, on controllers with planted faults and on sound ones.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "planted_plan.h"

namespace rehearse {
namespace {

/// The runs up to the finding; `most` if there is none in so many.
std::int64_t runs_to_find(const FuzzPlan& plan, bool guided, std::uint64_t seed, std::int64_t most) {
  FuzzOptions options;
  options.runs = most;
  options.seed = seed;
  options.guided = guided;
  options.most_findings = 1;
  options.shrinks = false;
  options.jobs = 2;
  const FuzzResult result = search_inputs(plan, options);
  return result.findings.empty() ? most : result.findings[0].run + 1;
}

std::int64_t median(std::vector<std::int64_t> numbers) {
  std::ranges::sort(numbers);
  return numbers[numbers.size() / 2];
}

class PlantedFault : public testing::TestWithParam<const char*> {};

TEST_P(PlantedFault, IsFoundInAFifthOfTheRunsOfRandomSearch) {
  const FuzzPlan plan = planted_plan(GetParam());
  std::vector<std::int64_t> guided, random;
  for (int seed = 1; seed <= PLANTED_SEEDS; ++seed)
    guided.push_back(runs_to_find(plan, true, static_cast<std::uint64_t>(seed), PLANTED_RUNS));
  const std::int64_t found = median(guided);
  ASSERT_LT(found, PLANTED_RUNS) << "it isn't found";
  for (int seed = 1; seed <= PLANTED_SEEDS; ++seed)
    random.push_back(runs_to_find(plan, false, static_cast<std::uint64_t>(seed), 5 * found));
  fmt::print("{:16} median of {} runs of guided search ({}); random search: {} in at most {}\n", GetParam(), found,
             fmt::join(guided, ", "), fmt::join(random, ", "), 5 * found);
  EXPECT_GE(median(random), 5 * found);
}

std::string name_of(const testing::TestParamInfo<const char*>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(ByDay, PlantedFault,
                         testing::Values("ChainOfThree", "SquareRoot", "ArcCosine", "BeyondTheTable", "Equality"),
                         name_of);
#if PLANTED_NIGHT
INSTANTIATE_TEST_SUITE_P(AtNight, PlantedFault,
                         testing::Values("ChainOfFive", "Gimbal", "WindUp", "UnitSlip", "SignSlip", "Uninitialised"),
                         name_of);
#endif

TEST(SoundControllers, HaveNoFinding) {
  for (const char* fault :
       {"ChainOfThree", "ChainOfFive",    "ForgottenEdge", "EdgeTakenTwice", "ZeroLength",    "SquareRoot", "ArcCosine",
        "Wraps",        "BeyondTheTable", "Stale",         "NotReset",       "Gimbal",        "WindUp",     "UnitSlip",
        "SignSlip",     "NoRateLimit",    "Latch",         "Equality",       "Uninitialised", "Sum"}) {
    FuzzOptions options;
    options.runs = SOUND_RUNS;
    options.jobs = 2;
    const FuzzResult result = search_inputs(planted_plan("sound " + std::string(fault)), options);
    EXPECT_EQ(result.runs, (SOUND_RUNS + 15) / 16 * 16) << fault;
    for (const FuzzFinding& finding : result.findings)
      ADD_FAILURE() << fault << ": " << finding.kind << ": " << finding.sentence << "\n" << finding.text;
  }
}

TEST(FuzzSearch, FindsTheSameWhateverTheNumberOfItsProcesses) {
  const FuzzPlan plan = planted_plan("Sum");
  FuzzOptions options;
  options.runs = 1600;
  options.seed = 4;
  std::vector<FuzzResult> results;
  for (const int jobs : {1, 3}) {
    options.jobs = jobs;
    results.push_back(search_inputs(plan, options));
  }
  ASSERT_FALSE(results[0].findings.empty()) << "nothing is compared";
  ASSERT_EQ(results[0].findings.size(), results[1].findings.size());
  EXPECT_EQ(results[0].kept, results[1].kept);
  EXPECT_EQ(results[0].points, results[1].points);
  EXPECT_GT(results[0].points, 10) << "the controller has the compiler's calls";
  for (std::size_t i = 0; i < results[0].findings.size(); ++i) {
    EXPECT_EQ(results[0].findings[i].run, results[1].findings[i].run);
    EXPECT_EQ(results[0].findings[i].sentence, results[1].findings[i].sentence);
    EXPECT_EQ(results[0].findings[i].text, results[1].findings[i].text);
  }
}

TEST(FuzzSearch, IsGuidedByVariablesWithoutTheCallsOfACompiler) {
  FuzzOptions options;
  options.runs = 256;
  options.jobs = 2;
  const FuzzResult plain = search_inputs(planted_plan("ForgottenEdge", "PlantedPlain"), options);
  EXPECT_EQ(plain.points, 0);
  EXPECT_GT(plain.kept, 1);
}

}  // namespace
}  // namespace rehearse
