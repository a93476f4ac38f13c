// `vary:` of a scenario: where the values are, and the text with others in their places.
#include "scenario_files.h"

#include "core/scenario/scenario_variations.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

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
  EXPECT_EQ(line_with("bodies[Box].mass", "3.5", any), "    mass: 3.5    # [kg]");
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

/// The scenario with a default replaced by that value.
Scenario with_default(const std::string& path, const std::string& value, const std::string& distribution) {
  const Scenario scenario = varied("  p: {path: \"" + path + "\", " + distribution + "}\n");
  return loaded(*scenario.varied_text({value}));
}

TEST(ScenarioVariations, FindDefaultsOfKeysThatTheScenarioDoesNotState) {
  const std::string any = "uniform: [0.1, 10]";
  EXPECT_EQ(line_with("bodies.Box.friction", "0.25", any), "    friction: 0.25") << "in lines of its own";
  EXPECT_EQ(with_default("bodies.Box.friction", "0.25", any).bodies[1].model->links[0].surface.friction, 0.25);
  EXPECT_EQ(with_default("gravity[2]", "-1.6", any).gravity, Eigen::Vector3d(0, 0, -1.6));
  EXPECT_EQ(with_default("solver.erp", "0.3", any).solver.erp, 0.3) << "in a map that isn't stated either";
  EXPECT_EQ(with_default("solver.method", "exact", "choice: [quick, exact]").solver.method,
            SolverSettings::Method::exact);
  EXPECT_EQ(with_default("bodies.Box.links.Box.mass", "7", any).bodies[1].model->mass(), 7.0);
  EXPECT_EQ(with_default("bodies.Box.velocity.linear[0]", "3", any).bodies[1].linear_velocity.x(), 3.0);
  EXPECT_EQ(with_default("seed", "12", any + ", integer: true").seed, 12u);
  EXPECT_EQ(with_default("bodies.Box.controllers.Holder.delay", "false", "choice: [true, false]")
                .bodies[1]
                .controllers[0]
                .delay,
            false);
  const Scenario in_braces = with_default("pushes[0].torque[1]", "4", any);
  EXPECT_EQ(in_braces.pushes[0].torque, Eigen::Vector3d(0, 4, 0)) << in_braces.text;
}

TEST(ScenarioVariations, FindTheDefaultsOfJointsAndLinksOfAModel) {
  const auto arm = [](const std::string& path, const std::string& value) {
    const Scenario scenario = loaded("rehearse: 1\nduration: 1\nbodies:\n  - name: Pendulum\n    model: " +
                                     (std::filesystem::path(FIXTURES_DIR) / "models/pendulum.urdf").string() +
                                     "\nvary:\n  p: {path: " + path + ", uniform: [0.1, 10]}\n");
    return loaded(*scenario.varied_text({value})).bodies[0];
  };
  EXPECT_EQ(arm("bodies.Pendulum.joints.hinge", "0.75").joints[0], 0.75);
  const ScenarioBody heavy = arm("bodies.Pendulum.links.rod.mass", "4");
  EXPECT_EQ(heavy.model->links[static_cast<std::size_t>(heavy.model->find_link("rod"))].inertial.mass, 4.0);
}

TEST(ScenarioVariations, CorrectAMisspeltDefault) {
  const auto said_of = [](const std::string& path) {
    return mistakes(load_text(world + "vary:\n  p: {path: " + path + ", uniform: [0, 1]}\n"));
  };
  EXPECT_THAT(said_of("bodies.Box.frction"),
              HasSubstr("the scenario states no 'frction' in 'bodies.Box' (did you mean 'friction'?"));
  EXPECT_THAT(said_of("bodies.Box.links.Box.mas"),
              HasSubstr("the scenario states no 'mas' in 'bodies.Box.links.Box' (did you mean 'mass'?"));
}

TEST(ScenarioVariations, HaveTheDefaultAsNominalValueAndLeaveItOut) {
  const Scenario scenario = varied("  g: {path: \"gravity[2]\", uniform: [-20, -1]}\n");
  EXPECT_EQ(scenario.variations[0].nominal, "-9.80665");
  EXPECT_EQ(*scenario.varied_text({"-9.80665"}), scenario.text);
}

TEST(ScenarioVariations, OfTwoDefaultsCanStandInOneMap) {
  const Scenario scenario = varied(
      "  mu: {path: bodies.Box.friction, uniform: [0, 1]}\n  bounce: {path: bodies.Box.restitution, uniform: [0, "
      "1]}\n");
  const Scenario changed = loaded(*scenario.varied_text({"0.25", "0.75"}));
  EXPECT_EQ(changed.bodies[1].model->links[0].surface.friction, 0.25);
  EXPECT_EQ(changed.bodies[1].model->links[0].surface.restitution, 0.75);
  EXPECT_THAT(mistakes(load_text(world + "vary:\n  x: {path: \"gravity[0]\", uniform: [0, 1]}\n"
                                         "  z: {path: \"gravity[2]\", uniform: [0, 1]}\n")),
              HasSubstr("'x' and 'z' vary parts of what the scenario doesn't state (state its nominal value)"));
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

TEST(ScenarioVariations, AreLoadedWithValuesByPath) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "load_with.yaml";
  std::ofstream(file) << world << "vary:\n  mass: {path: bodies.Box.mass, uniform: [1, 3]}\n";
  const auto scenario =
      load_with(file, {{"bodies[Box].mass", "8.2"}, {"gravity[2]", "-1.6"}, {"bodies.Box.friction", "0.25"}});
  ASSERT_TRUE(scenario) << to_string(scenario.errors());
  EXPECT_EQ(scenario->bodies[1].model->links[0].inertial.mass, 8.2);
  EXPECT_EQ(scenario->gravity.z(), -1.6);
  EXPECT_THAT(scenario->text, HasSubstr("    mass: 8.2    # [kg]"));
  EXPECT_THAT(scenario->text, HasSubstr("friction: 0.25"));
  EXPECT_EQ(scenario->variations.size(), 1u);

  const auto unknown = load_with(file, {{"bodies.Box.mas", "8.2"}});
  ASSERT_FALSE(unknown);
  EXPECT_THAT(to_string(unknown.errors()),
              HasSubstr("with 'bodies.Box.mas' at 8.2: the scenario states no 'mas' in 'bodies.Box'"));
  const auto wrong = load_with(file, {{"bodies.Box.mass", "-1"}, {"duration", "2"}});
  ASSERT_FALSE(wrong);
  EXPECT_THAT(to_string(wrong.errors()), HasSubstr("with 'bodies.Box.mass' at -1: mass is -1"));
  EXPECT_FALSE(load_with(file, {{"bodies.Box", "8"}}));
  EXPECT_FALSE(load_with("absent.yaml", {}));
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
