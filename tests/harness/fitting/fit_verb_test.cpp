// `rehearse fit`.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "hidden_robot.h"
#include "support/files.h"
#include "support/shell.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

class FitVerb : public test::HiddenRobot {
 protected:
  static std::string rod(double damping, int seed) {
    return scenario("pendulum",
                    fmt::format("    actuators: [{{joint: \"*\", damping: {}, velocity_gain: 0}}]\n", damping), "1",
                    1.0, seed);
  }
  FitVerb() {
    fly("monday", rod(0.3, 1) + noise);
    fly("friday", rod(0.5, 2) + noise);
    folder_.write("paper.yaml", rod(0.1, 1));
  }
  test::Output rehearse(const std::string& words) const {
    return test::run("cd " + folder_.path().string() + " && " REHEARSE_COMMAND " fit " + words);
  }
};

constexpr const char* to_damping = " --scenario paper.yaml --vary 'bodies.Robot.actuators[0].damping'";

TEST_F(FitVerb, WritesAFittedScenarioOnce) {
  const auto first = rehearse(std::string("monday.mcap -o fitted.yaml --json --judge friday.mcap") + to_damping);
  EXPECT_EQ(WEXITSTATUS(first.status), 0) << first.text;
  const auto result = nlohmann::json::parse(first.text, nullptr, false);
  ASSERT_TRUE(result.is_object()) << first.text;
  EXPECT_EQ(result["numbers"][0]["identified"], true);
  EXPECT_NEAR(result["numbers"][0]["value"].get<double>(), 0.3, 0.02);
  EXPECT_GT(result["judgement"]["before"], result["judgement"]["after"]);
  const auto fitted = Scenario::load(folder_ / "fitted.yaml");
  ASSERT_TRUE(fitted) << to_string(fitted.errors());
  EXPECT_EQ(fitted->bodies[0].actuators[0]->damping, result["numbers"][0]["value"].get<double>());
  EXPECT_THAT(test::read_file(folder_ / "fitted.yaml"),
              HasSubstr("# paper.yaml with numbers that were fitted to monday.mcap:"));

  const auto refused = rehearse(std::string("monday.mcap -o fitted.yaml") + to_damping);
  EXPECT_EQ(WEXITSTATUS(refused.status), 2);
  EXPECT_THAT(refused.text, HasSubstr("fitted.yaml: error: it exists (--force replaces it)"));
  const auto forced = rehearse(std::string("monday.mcap -o fitted.yaml --force") + to_damping);
  EXPECT_EQ(WEXITSTATUS(forced.status), 0) << forced.text;
  EXPECT_THAT(forced.text, HasSubstr("wrote fitted.yaml"));
  EXPECT_THAT(forced.text, HasSubstr("times the noise; before "));
  EXPECT_THAT(rehearse(std::string("monday.mcap -o /tmp/fitted.yaml") + to_damping).text,
              HasSubstr("it isn't in the folder of the scenario"));
}

TEST_F(FitVerb, EndsWith4IfNothingIsIdentifiable) {
  const auto told =
      rehearse("monday.mcap -o none.yaml --scenario paper.yaml --vary 'bodies.Robot.actuators[0].velocity_gain=0..2'");
  EXPECT_EQ(WEXITSTATUS(told.status), 4) << told.text;
  EXPECT_THAT(told.text, HasSubstr("bodies.Robot.actuators[0].velocity_gain isn't identifiable: nothing that is "
                                   "compared depends on it\n  what could decide it: "));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.yaml"));
}

TEST_F(FitVerb, SaysWhatMovedBetweenTwoRecordings) {
  const auto moved = rehearse(std::string("--wear monday.mcap friday.mcap") + to_damping);
  EXPECT_EQ(WEXITSTATUS(moved.status), 1) << moved.text;
  EXPECT_THAT(moved.text, HasSubstr("bodies.Robot.actuators[0].damping grew from 0."));
  EXPECT_THAT(moved.text, HasSubstr("the robot changed: 1 of 1 number moved beyond both intervals"));
  const auto same = rehearse(std::string("--wear monday.mcap monday.mcap") + to_damping);
  EXPECT_EQ(WEXITSTATUS(same.status), 0) << same.text;
  EXPECT_THAT(same.text, HasSubstr("nothing moved beyond both intervals, of 1 number"));
  EXPECT_THAT(rehearse(std::string("--wear monday.mcap") + to_damping).text,
              HasSubstr("--wear compares two recordings, not 1"));
}

}  // namespace
}  // namespace rehearse
