// `vary:` of a scenario: where the values are, and the text with others in their places.
#include "scenario_files.h"

#include "core/scenario/scenario_variations.h"

#include <gmock/gmock.h>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

const std::string world = R"(rehearse: 1
duration: 1
bodies:
  - name: Floor
    box: {size: [2, 2, 0.2]}
    fixed: true
    friction: 0.5
  - name: Box    # it falls
    box: {size: [0.2, 0.2, 0.2]}
    mass: 2    # [kg]
    position: [0, 0.5, 1e0]
    rotation: [5 deg, 0, 0]
    controllers:
      - library: Holder
        options: "{stiffness: 80, gain: 1}"
      - {library: "Other.so", name: Second, options: "gain=2 offset = 3", delay: true}
pushes:
  - {body: Box, link: Box, force: [1, 0, 0], from: 0.1, until: 0.2}
)";

Scenario varied(const std::string& vary) { return loaded(world + "vary:\n" + vary); }

/// The line of the text with that value in the place of the only variation.
std::string line_with(const std::string& path, const std::string& value, const std::string& distribution) {
  const Scenario scenario = varied("  p: {path: \"" + path + "\", " + distribution + "}\n");
  const auto text = scenario.varied_text({value});
  if (!text) return to_string(text.errors());
  std::istringstream now(*text), before(scenario.text);
  std::string line, old;
  while (std::getline(now, line) && std::getline(before, old))
    if (line != old) return line;
  return "";
}

TEST(ScenarioVariations, FindTheirValuesByPath) {
  const std::string any = "uniform: [0.1, 10]";
  EXPECT_EQ(line_with("bodies.Box.mass", "3.5", any), "    mass: 3.5    # [kg]");
  EXPECT_EQ(line_with("bodies[1].mass", "3.5", any), "    mass: 3.5    # [kg]");
  EXPECT_EQ(line_with("bodies.Box.position[2]", "0.25", any), "    position: [0, 0.5, 0.25]");
  EXPECT_EQ(line_with("bodies.Box.rotation[0]", "7", any), "    rotation: [7 deg, 0, 0]") << "the unit stays";
  EXPECT_EQ(line_with("pushes[0].until", "0.3", any),
            "  - {body: Box, link: Box, force: [1, 0, 0], from: 0.1, until: 0.3}");
  EXPECT_EQ(line_with("duration", "2", any), "duration: 2");
}

TEST(ScenarioVariations, FindKeysInOptionStrings) {
  const std::string any = "uniform: [0.1, 10]";
  EXPECT_EQ(line_with("bodies.Box.controllers.Holder.options.stiffness", "90", any),
            "        options: \"{stiffness: 90, gain: 1}\"");
  EXPECT_EQ(line_with("bodies.Box.controllers.Holder.options.gain", "2", any),
            "        options: \"{stiffness: 80, gain: 2}\"");
  EXPECT_EQ(line_with("bodies.Box.controllers.Second.options.gain", "5", any),
            "      - {library: \"Other.so\", name: Second, options: \"gain=5 offset = 3\", delay: true}");
  EXPECT_EQ(line_with("bodies.Box.controllers.Second.options.offset", "5", any),
            "      - {library: \"Other.so\", name: Second, options: \"gain=2 offset = 5\", delay: true}");
}

TEST(ScenarioVariations, WriteWordsSoThatTheyAreRead) {
  EXPECT_EQ(line_with("bodies.Box.controllers.Second.delay", "false", "choice: [true, false]"),
            "      - {library: \"Other.so\", name: Second, options: \"gain=2 offset = 3\", delay: false}");
  EXPECT_EQ(line_with("bodies.Box.controllers.Second.library", "My other.so", "choice: [a, b]"),
            "      - {library: \"My other.so\", name: Second, options: \"gain=2 offset = 3\", delay: true}");
  EXPECT_EQ(line_with("bodies.Box.controllers.Holder.library", "a: b", "choice: [a, b]"), "      - library: \"a: b\"");
  EXPECT_EQ(line_with("bodies.Box.rotation[0]", "0.1 rad", "choice: [5 deg, 0.1 rad]"),
            "    rotation: [\"0.1 rad\", 0, 0]");
  EXPECT_THAT(line_with("bodies.Box.controllers.Holder.library", "a\"b", "choice: [a, b]"), HasSubstr("quotes"));
}

TEST(ScenarioVariations, LeaveARunAsItIsStated) {
  const Scenario scenario = varied("  height: {path: \"bodies.Box.position[2]\", uniform: [3, 4]}\n");
  EXPECT_EQ(scenario.variations.size(), 1u);
  EXPECT_EQ(scenario.variations[0].nominal, "1e0");
  EXPECT_EQ(scenario.bodies[1].position.z(), 1.0);
  const auto same = scenario.varied_text({""});
  ASSERT_TRUE(same);
  EXPECT_EQ(*same, scenario.text);
}

TEST(ScenarioVariations, ChangeOfAnAnchorIsRefused) {
  const std::string message = mistakes(
      load_text("rehearse: 1\nduration: &d 1\nhorizon: *d\nbodies:\n  - {name: B, box: {size: [1, 1, 1]}, mass: 1}\n"
                "vary:\n  d: {path: duration, uniform: [1, 2]}\n"));
  EXPECT_THAT(message, HasSubstr("written with an anchor, a tag or in several lines"));
}

TEST(ScenarioVariations, TextWithoutAKeyKeepsTheRest) {
  const auto text = text_without(world + "vary:\n  a: {}\nexpect: []\n", "x.yaml", "vary");
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, world + "expect: []\n");
  const auto last = text_without(world + "vary:\n  a: {}\n", "x.yaml", "vary");
  ASSERT_TRUE(last);
  EXPECT_EQ(*last, world);
  EXPECT_EQ(*text_without(world, "x.yaml", "vary"), world);
}

}  // namespace
}  // namespace rehearse
