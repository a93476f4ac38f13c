// The findings of fuzz tests: how a run ends, their smallest form, their files, and a search that goes on.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "planted_plan.h"
#include "support/shell.h"
#include "support/temporary_folder.h"

// A sound controller as a user would test it.
FUZZ_CONTROLLER(Trio, KeepsItsLimits, PLANTED_CONTROLLERS "/Planted.so", PLANTED_MODEL)
    .joint("A", q.in(-1, 1), dq.in(-3, 3))
    .device("Imu", within_limits())
    .options("sound Latch")
    .ticks(16)
    .runs(64)
    .expect("always: abs(Trio/A/u) < 20.1 N·m");

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string thrown_by(const FuzzPlan& plan) {
  try {
    search_inputs(plan, {});
  } catch (const std::runtime_error& failure) {
    return failure.what();
  }
  return "nothing";
}

FuzzResult result_of(const FuzzPlan& plan, const std::string& folder = {}, std::int64_t runs = 800) {
  FuzzOptions options;
  options.runs = runs;
  options.seed = 3;
  options.most_findings = 1;
  options.jobs = 2;
  options.folder = folder;
  return search_inputs(plan, options);
}

TEST(FuzzFindings, AreTheEndOfARunAndNotOfTheTest) {
  for (const auto& [fault, kind] :
       {std::pair("Throws", "threw"), std::pair("Crashes", "crashed"), std::pair("EndsTheProcess", "ended the process"),
        std::pair("Hangs", "hung"), std::pair("EatsMemory", "took too much memory")}) {
    FuzzPlan plan = planted_plan(fault);
    plan.ticks = 16;
    plan.call_limit = fault == std::string("EatsMemory") ? 20.0 : 0.3;
    plan.memory_limit = 300.0;
    const FuzzResult result = result_of(plan);
    ASSERT_EQ(result.findings.size(), 1u) << fault;
    EXPECT_EQ(result.findings[0].kind, kind) << result.findings[0].sentence;
    fmt::print("{:16} run {}: {}\n", fault, result.findings[0].run, result.findings[0].sentence);
  }
}

TEST(FuzzFindings, AreShrunkToWhatAPersonReads) {
  const TemporaryFolder folder;
  fmt::print("{:16} {:>14} {:>14} {:>14}\n", "fault", "ticks", "inputs", "changes");
  for (const char* fault : {"ChainOfThree", "Equality", "SquareRoot", "Sum", "WindUp"}) {
    const FuzzResult result = result_of(planted_plan(fault), (folder / "failures").string(), 6400);
    ASSERT_EQ(result.findings.size(), 1u) << fault;
    const FuzzFinding& found = result.findings[0];
    fmt::print("{:16} {:>14} {:>14} {:>14}\n", fault, fmt::format("{} -> {}", found.ticks_before, found.ticks),
               fmt::format("{} -> {}", found.inputs_before, found.inputs),
               fmt::format("{} -> {}", found.changes_before, found.changes));
    EXPECT_LE(found.changes, 8) << found.text;
    EXPECT_LE(found.ticks, fault == std::string("WindUp") ? 40 : 2) << found.text;
    EXPECT_TRUE(found.repeats) << fault;
    EXPECT_TRUE(fs::exists(found.file));
    ASSERT_FALSE(found.recording.empty());
    const auto replayed = test::run(std::string(REHEARSE_COMMAND) + " replay " + found.recording);
    EXPECT_EQ(replayed.status, 0) << replayed.text;
  }
}

TEST(FuzzFindings, AreFilesThatTheTestRunsAgain) {
  const TemporaryFolder folder;
  const FuzzPlan plan = planted_plan("Equality");
  const FuzzResult result = result_of(plan, folder.path().string());
  ASSERT_EQ(result.findings.size(), 1u);
  std::ifstream in(result.findings[0].file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(text, result.findings[0].text);
  EXPECT_THAT(text, HasSubstr("\nticks 1\ntick 0 A/q = 0.3712\n"));
  EXPECT_THAT(text, StartsWith("# beyond a limit: A/u is 100 N·m at tick 0, beyond its limit of 20 N·m\n"));

  const auto again = run_kept_inputs(plan, folder.path().string());
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].file, result.findings[0].file);
  EXPECT_THAT(again[0].sentence, StartsWith("A/u is 100 N·m"));
  const auto mended = run_kept_inputs(planted_plan("sound Equality"), folder.path().string());
  ASSERT_EQ(mended.size(), 1u);
  EXPECT_EQ(mended[0].sentence, "");
  EXPECT_TRUE(run_kept_inputs(planted_plan("Sum"), folder.path().string()).empty()) << "they are of another test";
}

TEST(FuzzFindings, FailTheirTestWithTheCommandThatStepsThroughThem) {
  const TemporaryFolder folder;
  const TestFolders before = test_folders();
  set_test_folders({"", (folder / "golden").string(), folder.path().string(), ""});
  FuzzPlan plan = planted_plan("Equality");
  plan.runs = 800;
  plan.seed = 3;
  const internal::TestVerdict first = internal::run_fuzz_test(plan);
  const internal::TestVerdict second = internal::run_fuzz_test(plan);
  set_test_folders(before);
  EXPECT_FALSE(first.passed);
  EXPECT_THAT(first.message, HasSubstr("rehearse step " + (folder / "failures").string()));
  EXPECT_FALSE(second.passed);
  EXPECT_THAT(second.message, HasSubstr("a kept finding fails again: " + (folder / "failures").string()));
}

TEST(FuzzFindings, OfAnUnreadFileNameTheMistakeAndItsLine) {
  for (const auto& [text, mistake] :
       {std::pair("ticks 4\ntick 1 D/q = 1\n", "2: error: the test states no input 'D/q'"),
        std::pair("tick 1 A/q = 1\n", "1: error: the first line that isn't a comment states no ticks"),
        std::pair("ticks 0\n", "1: error: '0' is no number of ticks"),
        std::pair("# a comment\n\nticks 4\ntick 4 A/q = 0.5\n", "4: error: there is no tick '4'"),
        std::pair("ticks 4\ntick 0 A/q = 1.5\n", "2: error: '1.5' is no value of A/q"),
        std::pair("ticks 4\ntick 0 A/q = nan\n", "2: error: 'nan' is no value of A/q"),
        std::pair("ticks 4\ntick 0 A/q 0.5\n", "2: error: a line is no change of an input"),
        std::pair("# nothing\n", "error: it states no ticks")}) {
    const TemporaryFolder folder;
    folder.write("Planted.Equality-1.inputs", text);
    try {
      run_kept_inputs(planted_plan("Equality"), folder.path().string());
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& failure) {
      EXPECT_THAT(failure.what(), HasSubstr(mistake));
    }
  }
}

TEST(FuzzPlan, NamesItsMistakes) {
  FuzzPlan plan = planted_plan("Equality");
  plan.joints.push_back({"D", {}});
  EXPECT_THAT(thrown_by(plan), HasSubstr("the model has no joint \"D\" (it has A, B, C)"));
  plan = planted_plan("Equality");
  plan.joints[0].ranges[0].low = 2.0;
  EXPECT_THAT(thrown_by(plan), HasSubstr("the range of A/q goes from 2 to 1"));
  plan = planted_plan("Equality");
  plan.devices.push_back({"Nose", {}});
  EXPECT_THAT(thrown_by(plan), HasSubstr("the model has no device \"Nose\" (it has Imu)"));
  plan = planted_plan("Equality");
  plan.expectations = {"Trio/A/u < 20"};
  EXPECT_THAT(thrown_by(plan), HasSubstr("\"Trio/A/u < 20\" is no expectation"));
  plan.expectations = {"always: Trio/Z/u < 20 N·m"};
  EXPECT_THAT(thrown_by(plan), HasSubstr("Trio/Z/u"));
  plan.expectations = {"always: Trio/A/u < 20 m"};
  EXPECT_THAT(thrown_by(plan), HasSubstr("N·m"));
  plan = planted_plan("NoSuchFault");
  EXPECT_THAT(thrown_by(plan), HasSubstr("refuses to take part"));
  plan = planted_plan("Equality", "NoSuchLibrary");
  EXPECT_THAT(thrown_by(plan), HasSubstr("NoSuchLibrary"));
  plan = planted_plan("Equality");
  plan.joints.clear();
  plan.devices.clear();
  EXPECT_THAT(thrown_by(plan), HasSubstr("it states no input"));
  plan = planted_plan("Equality");
  plan.seeds = "NoGolden.*";
  EXPECT_THAT(thrown_by(plan), HasSubstr("no golden matches the seeds 'NoGolden.*'"));
}

TEST(FuzzSearchState, GoesOnAsIfItHadNotEnded) {
  const TemporaryFolder folder;
  FuzzOptions options;
  options.seed = 2;
  options.jobs = 2;
  options.shrinks = false;
  options.runs = 640;
  const FuzzPlan plan = planted_plan("ForgottenEdge");
  const FuzzResult whole = search_inputs(plan, options);
  options.state = (folder / "fuzz/state.json").string();
  options.runs = 320;
  search_inputs(plan, options);
  options.runs = 640;
  const FuzzResult resumed = search_inputs(plan, options);
  EXPECT_EQ(resumed.resumed_from, 320);
  EXPECT_EQ(resumed.runs, whole.runs);
  EXPECT_EQ(resumed.kept, whole.kept);
  EXPECT_EQ(resumed.points, whole.points);
  options.seed = 5;
  EXPECT_EQ(search_inputs(plan, options).resumed_from, 0) << "another search begins anew";
}

}  // namespace
}  // namespace rehearse
