// `rehearse fuzz`, which finds the program of a test and goes on with its search.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "support/shell.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class FuzzVerb : public testing::Test {
 protected:
  FuzzVerb() {
    std::string tests;
    for (const char* name : {"Planted.ComparesFloats", "Planted.NamesNoJoint", "Planted.IsNoFuzzTest"})
      tests += std::string("add_test(") + name + " " PLANTED_FUZZ " --gtest_filter=" + name + ")\n";
    folder_.write("build/CTestTestfile.cmake", tests);
  }
  test::Output rehearse(const std::string& words) const {
    return test::run("cd " + folder_.path().string() + " && " REHEARSE_COMMAND " " + words);
  }

  const test::TemporaryFolder folder_;
};

TEST_F(FuzzVerb, GoesOnWithTheSearchOfATestAndKeepsItsFindings) {
  const auto first = rehearse("fuzz Planted.ComparesFloats --runs 1600 --json");
  EXPECT_EQ(WEXITSTATUS(first.status), 1) << first.text;
  const auto result = nlohmann::json::parse(first.text, nullptr, false);
  ASSERT_TRUE(result.is_object()) << first.text;
  ASSERT_EQ(result["findings"].size(), 1u);
  EXPECT_EQ(result["findings"][0]["kind"], "beyond a limit");
  EXPECT_EQ(result["findings"][0]["changes"], 1);
  EXPECT_EQ(result["findings"][0]["repeats"], true);
  EXPECT_EQ(result["resumed_from"], 0);

  const auto second = rehearse("fuzz Planted.ComparesFloats --runs 3200 -j 1");
  EXPECT_EQ(WEXITSTATUS(second.status), 1) << second.text;
  EXPECT_THAT(second.text, HasSubstr("1 finding in 3200 runs, 1600 of them earlier, seed 0"));
  EXPECT_THAT(second.text, HasSubstr("a kept finding fails again: "));
  EXPECT_THAT(second.text, HasSubstr("tick by tick: rehearse step "));
}

TEST_F(FuzzVerb, RefusesWhatIsNoFuzzTest) {
  EXPECT_THAT(rehearse("fuzz Planted.IsNoFuzzTest").text, HasSubstr("Planted.IsNoFuzzTest made no search"));
  EXPECT_THAT(rehearse("fuzz Planted.Nothing").text, HasSubstr("there is no test 'Planted.Nothing' in build"));
  EXPECT_THAT(rehearse("fuzz Planted.ComparesFloats --build absent").text, HasSubstr("this is no build with tests"));
  const auto time = rehearse("fuzz Planted.ComparesFloats --for 3weeks");
  EXPECT_EQ(WEXITSTATUS(time.status), 2);
  EXPECT_THAT(time.text, HasSubstr("'3weeks' is no time: expected as 30s, 10min or 2h"));
}

TEST_F(FuzzVerb, SaysTheMistakeOfATestAlone) {
  const auto told = rehearse("fuzz Planted.NamesNoJoint");
  EXPECT_EQ(WEXITSTATUS(told.status), 2);
  EXPECT_EQ(told.text, "error: the fuzz test Planted.NamesNoJoint: the model has no joint \"D\" (it has A, B, C)\n");
}

TEST_F(FuzzVerb, ATestFailsAtItsLine) {
  for (const char* name : {"ComparesFloats", "NamesNoJoint"}) {
    const auto failed =
        test::run("cd " + folder_.path().string() + " && " PLANTED_FUZZ " --gtest_filter=Planted." + name);
    EXPECT_NE(failed.status, 0);
    EXPECT_THAT(failed.text, ContainsRegex("planted_fuzz.cpp:[0-9]+: Failure")) << name;
  }
}

}  // namespace
}  // namespace rehearse
