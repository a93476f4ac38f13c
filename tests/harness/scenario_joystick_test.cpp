// A scripted joystick of a scenario: its readings over time, and warnings about improbable scripts. The mistakes, one
// by one, are in scenario_broken_test.cpp.
#include "scenario_files.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t l_stick_v = 1, l_trigger = 6;
constexpr std::size_t button_a = 0, button_b = 1;

/// The joystick of a scenario with these entries, each a line.
JoystickScript joystick(const std::string& entries) {
  const Scenario scenario = loaded(ball_with("joystick:\n" + entries));
  EXPECT_THAT(to_string(scenario.warnings), IsEmpty());
  return scenario.joystick.value_or(JoystickScript());
}

TEST(ScriptedJoystick, IsThereOnlyIfTheScenarioHasOne) {
  EXPECT_FALSE(loaded(ball_with("")).joystick.has_value());
  EXPECT_TRUE(loaded(ball_with("joystick: []\n")).joystick.has_value());
}

TEST(ScriptedJoystick, IsUntouchedBeforeTheFirstEntry) {
  const JoystickScript script = joystick("  - {at: 0.5, axes: {L_STICK_V: -1}, buttons: {A: true}}\n");
  EXPECT_EQ(script.at(0.0), JoystickReading());
  EXPECT_EQ(script.at(0.499), JoystickReading());
}

TEST(ScriptedJoystick, HoldsAnAxisUntilTheNextEntry) {
  const JoystickScript script = joystick(
      "  - {at: 0.25, axes: {L_STICK_V: -1, L_TRIGGER: 0.5}}\n"
      "  - {at: 0.5, axes: {L_STICK_V: 0.75}}\n");
  EXPECT_EQ(script.at(0.25).axes[l_stick_v], -1.0f);
  EXPECT_EQ(script.at(0.499).axes[l_stick_v], -1.0f);
  EXPECT_EQ(script.at(0.5).axes[l_stick_v], 0.75f);
  EXPECT_EQ(script.at(100.0).axes[l_stick_v], 0.75f);
  EXPECT_EQ(script.at(100.0).axes[l_trigger], 0.5f) << "the second entry doesn't name it";
}

TEST(ScriptedJoystick, HoldsAButtonUntilItIsLetGo) {
  const JoystickScript script = joystick(
      "  - {at: 0.25, buttons: {A: true}}\n"
      "  - {at: 0.5, buttons: {B: true}}\n"
      "  - {at: 0.75, buttons: {A: false}}\n");
  EXPECT_FALSE(script.at(0.249).buttons[button_a]);
  EXPECT_TRUE(script.at(0.25).buttons[button_a]);
  EXPECT_TRUE(script.at(0.5).buttons[button_a]);
  EXPECT_FALSE(script.at(0.75).buttons[button_a]);
  EXPECT_TRUE(script.at(0.75).buttons[button_b]);
}

TEST(ScriptedJoystick, KnowsEveryControlByNameAndByNumber) {
  for (std::size_t i = 0; i < joystick_axes.size(); ++i) {
    const std::string name(joystick_axes[i]), number = std::to_string(i);
    const JoystickReading named = joystick("  - {at: 0, axes: {" + name + ": 1}}\n").at(0.0);
    EXPECT_EQ(named.axes[i], 1.0f) << name;
    EXPECT_EQ(named, joystick("  - {at: 0, axes: {" + number + ": 1}}\n").at(0.0)) << name;
  }
  for (std::size_t i = 0; i < joystick_buttons.size(); ++i) {
    const std::string name(joystick_buttons[i]), number = std::to_string(i);
    const JoystickReading named = joystick("  - {at: 0, buttons: {" + name + ": true}}\n").at(0.0);
    EXPECT_TRUE(named.buttons[i]) << name;
    EXPECT_EQ(named, joystick("  - {at: 0, buttons: {" + number + ": true}}\n").at(0.0)) << name;
  }
}

TEST(ScriptedJoystick, MovesAnAxisInAStraightLineOverATime) {
  const JoystickScript script = joystick("  - {at: 0.25, axes: {L_STICK_V: -1}, buttons: {A: true}, over: 0.5}\n");
  EXPECT_EQ(script.at(0.25).axes[l_stick_v], 0.0f);
  EXPECT_EQ(script.at(0.375).axes[l_stick_v], -0.25f);
  EXPECT_EQ(script.at(0.5).axes[l_stick_v], -0.5f);
  EXPECT_EQ(script.at(0.75).axes[l_stick_v], -1.0f);
  EXPECT_EQ(script.at(2.0).axes[l_stick_v], -1.0f);
  EXPECT_TRUE(script.at(0.25).buttons[button_a]) << "a button takes no time";
}

TEST(ScriptedJoystick, LetsAnEntryTakeOverAnAxisOnItsWay) {
  const JoystickScript script = joystick(
      "  - {at: 0, axes: {L_STICK_V: 1}, over: 1}\n"
      "  - {at: 0.5, axes: {L_STICK_V: 0}, over: 0.25}\n");
  EXPECT_EQ(script.at(0.5).axes[l_stick_v], 0.5f) << "from where it is";
  EXPECT_EQ(script.at(0.625).axes[l_stick_v], 0.25f);
  EXPECT_EQ(script.at(0.75).axes[l_stick_v], 0.0f);
  EXPECT_EQ(script.at(1.0).axes[l_stick_v], 0.0f) << "the first way is given up";
}

TEST(ScriptedJoystick, MovesTwoAxesAtOneTimeAtSpeedsOfTheirOwn) {
  const JoystickScript script = joystick(
      "  - {at: 0, axes: {L_STICK_V: 1}, over: 1}\n"
      "  - {at: 0, axes: {L_TRIGGER: 1}, over: 0.5}\n");
  EXPECT_EQ(script.at(0.25).axes[l_stick_v], 0.25f);
  EXPECT_EQ(script.at(0.25).axes[l_trigger], 0.5f);
}

TEST(ScriptedJoystick, IsAFunctionOfTimeAlone) {
  const JoystickScript script = joystick(
      "  - {at: 0, axes: {L_STICK_V: 1, R_STICK_H: -0.3}, over: 0.7}\n"
      "  - {at: 0.1, buttons: {A: true}}\n"
      "  - {at: 0.4, axes: {L_STICK_V: -1}, buttons: {A: false, LOGO: true}, over: 0.3}\n");
  std::vector<JoystickReading> forwards;
  for (int tick = 0; tick < 1000; ++tick) forwards.push_back(script.at(tick / 1000.0));
  for (int tick = 999; tick >= 0; tick -= 7)
    EXPECT_EQ(script.at(tick / 1000.0), forwards[static_cast<std::size_t>(tick)]);
}

TEST(ScriptedJoystick, ReadsTheSinglePrecisionNumberNearestToWhatIsWritten) {
  EXPECT_EQ(joystick("  - {at: 0, axes: {L_STICK_V: 0.3}}\n").at(0.0).axes[l_stick_v], 0.3f);
}

TEST(ScriptedJoystick, NeverOvershootsOnItsWay) {
  const JoystickScript script = joystick("  - {at: 0.1, axes: {L_STICK_V: 1}, over: 0.3}\n");
  for (int tick = 0; tick < 1000; ++tick) EXPECT_LE(script.at(tick / 1000.0).axes[l_stick_v], 1.0f) << tick;
}

TEST(ScriptedJoystick, TellsAllItsMistakesInOneGo) {
  const auto result =
      load_text(ball_with("joystick:\n"
                          "  - {at: 0.5, axes: {L_STICK_W: 1, L_TRIGGER: 2}, buttons: {A: on}}\n"
                          "  - {at: 0.25, buttons: {B: true}}\n"
                          "  - {at: 0.75}\n"));
  ASSERT_FALSE(result.ok());
  const std::vector<std::pair<int, int>> places{{5, 22}, {5, 47}, {5, 64}, {6, 10}, {7, 5}};
  ASSERT_EQ(result.errors().size(), places.size()) << mistakes(result);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(result.errors()[i].line, places[i].first) << mistakes(result);
    EXPECT_EQ(result.errors()[i].column, places[i].second) << mistakes(result);
  }
}

TEST(ScriptedJoystick, WarnsOfAnEntryThatNeverComes) {
  const Scenario scenario = loaded(ball_with("joystick: [{at: 1, buttons: {A: true}}]\n"));
  EXPECT_THAT(
      to_string(scenario.warnings),
      HasSubstr(":4:17: warning: the joystick entry begins at 1 s, after the end of the run (the duration is 1 s)"));
}

TEST(ScriptedJoystick, WarnsOfAButtonThatIsPressedAndNeverLetGo) {
  const Scenario scenario =
      loaded(ball_with("joystick: [{at: 0.25, buttons: {A: true}}, {at: 0.5, buttons: {A: true}}]\n"));
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr(":4:44: warning: nothing changes at 0.5 s"));
}

TEST(ScriptedJoystick, WarnsOfAnAxisThatIsThereAlready) {
  const Scenario scenario = loaded(ball_with("joystick: [{at: 0.25, axes: {L_STICK_V: 0}, over: 0.5}]\n"));
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr(":4:12: warning: nothing changes at 0.25 s"));
}

TEST(ScriptedJoystick, StopsAnAxisOnItsWayWithoutAWarning) {
  const JoystickScript script = joystick(
      "  - {at: 0, axes: {L_STICK_V: 1}, over: 0.5}\n"
      "  - {at: 0.25, axes: {L_STICK_V: 1}}\n");
  EXPECT_EQ(script.at(0.25).axes[l_stick_v], 1.0f);
}

}  // namespace
}  // namespace rehearse
