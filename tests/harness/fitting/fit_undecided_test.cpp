// Numbers that a recording doesn't decide are never claimed, and mistakes are said.
#include <rehearse/fit.h>

#include <cmath>

#include "hidden_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class UndecidedFit : public test::HiddenRobot {
 protected:
  static std::string rod(const std::string& actuator, const std::string& more = "", const std::string& options = "1") {
    return scenario("pendulum", "    actuators: [{joint: \"*\"" + actuator + "}]\n", options, 1.0) + more;
  }
  std::string mistake_of(const std::string& recording, const FitRequest& request) const {
    const auto result = fit_to({recording}, rod(", damping: 0.2, delay: 0"), {request});
    return result ? "none" : to_string(result.errors());
  }
};

constexpr const char* damping = "bodies.Robot.actuators[0].damping";

TEST_F(UndecidedFit, ClaimsNoMassOfAFixedBase) {
  const std::string text = rod(", damping: 0.2", "    links: {BASE: {mass: 5}}\n");
  const auto result =
      fit_to({fly("flight", text + noise)}, text, {{"bodies.Robot.links.BASE.mass", {}, {}}, {damping, {}, {}}});
  ASSERT_TRUE(result) << to_string(result.errors());
  EXPECT_EQ(result->numbers[0].reason, "nothing that is compared depends on it");
  EXPECT_TRUE(result->numbers[1].is_identified());
  EXPECT_TRUE(result->identifies_any());
  EXPECT_THAT(result->text, HasSubstr("links: {BASE: {mass: 5}}"));
}

TEST_F(UndecidedFit, ClaimsNoTwoNumbersOfOneEffect) {
  struct Row {
    const char* actuator;
    const char* more;
    const char* options;  // "q": the drive's own loop acts
    std::string a, b;
  };
  const Row rows[] = {{", damping: 0.2, velocity_gain: 0.5, position_gain: 20", "", "q", damping,
                       "bodies.Robot.actuators[0].velocity_gain"},
                      {", armature: 0.02", "    links: {ARM: {mass: 1}}\ngravity: [0, 0, 0]\n", "1",
                       "bodies.Robot.actuators[0].armature", "bodies.Robot.links.ARM.mass"}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.a);
    const std::string text = rod(row.actuator, row.more, row.options);
    const auto result = fit_to({fly("flight", text + noise)}, text, {{row.a, {}, {}}, {row.b, {}, {}}});
    ASSERT_TRUE(result) << to_string(result.errors());
    EXPECT_FALSE(result->identifies_any());
    for (const FittedNumber& number : result->numbers) {
      EXPECT_NE(number.reason, "");
      EXPECT_TRUE(std::isnan(number.value));
    }
  }
}

TEST_F(UndecidedFit, ClaimsNothingOfARobotAtRest) {
  const std::string text = rod(", damping: 0.2, coulomb: 0.1", "", "0");
  const auto result =
      fit_to({fly("flight", text + noise)}, text, {{damping, {}, {}}, {"bodies.Robot.actuators[0].coulomb", {}, {}}});
  ASSERT_TRUE(result) << to_string(result.errors());
  EXPECT_FALSE(result->identifies_any());
  EXPECT_THAT(result->numbers[0].advice, HasSubstr("motion at several speeds"));
}

TEST_F(UndecidedFit, SaysMistakes) {
  const std::string flight = fly("flight", rod(", damping: 0.2") + noise);
  EXPECT_THAT(mistake_of(flight, {"bodies.Robot.actuators[0].dampng", {}, {}}), HasSubstr("dampng"));
  EXPECT_THAT(mistake_of(flight, {"bodies.Robot.model", {}, {}}), HasSubstr("not a number"));
  EXPECT_THAT(mistake_of(flight, {"bodies.Robot.actuators[0].delay", {}, {}}),
              HasSubstr("'bodies.Robot.actuators[0].delay' is 0, from which no bounds follow"));
  EXPECT_THAT(mistake_of(flight, {damping, 2.0, 1.0}), HasSubstr("which isn't above their beginning"));
  EXPECT_THAT(mistake_of(path("absent.mcap"), {damping, {}, {}}), HasSubstr("absent.mcap"));
}

}  // namespace
}  // namespace rehearse
