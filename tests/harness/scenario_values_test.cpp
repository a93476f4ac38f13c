// Values: numbers, angles, rotations, and their treatment by YAML.
#include "scenario_files.h"

#include <gmock/gmock.h>

#include <locale>
#include <numbers>

namespace rehearse {
namespace {

using ::testing::HasSubstr;

constexpr double pi = std::numbers::pi;

Eigen::Quaterniond rotation_of(const std::string& text) {
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies: [{name: Ball, sphere: {radius: 1}, mass: 1, rotation: " + text + "}]\n");
  return scenario.bodies.empty() ? Eigen::Quaterniond(0, 0, 0, 0) : scenario.bodies[0].rotation;
}

double duration_of(const std::string& text) {
  return loaded("rehearse: 1\nduration: " + text + "\nbodies: [{name: Ball, sphere: {radius: 1}, mass: 1}]\n").duration;
}

TEST(ScenarioValues, ReadsNumbersInAllForms) {
  EXPECT_EQ(duration_of("2"), 2.0);
  EXPECT_EQ(duration_of("+2.5"), 2.5);
  EXPECT_EQ(duration_of(".5"), 0.5);
  EXPECT_EQ(duration_of("1e3"), 1000.0);
  EXPECT_EQ(duration_of("010"), 10.0);  // never octal
  EXPECT_EQ(duration_of("0.1"), 0.1);
}

TEST(ScenarioValues, RefusesWhatOnlyLooksLikeANumber) {
  for (const char* text : {"0x10", "1_000", "1,5", "+-1", "1e", "--1", "1 2", "True", "~", "1e400", "-.inf", ".nan"}) {
    const auto result = load_text("rehearse: 1\nduration: " + std::string(text) +
                                  "\nbodies: [{name: Ball, sphere: {radius: 1}, mass: 1}]\n");
    EXPECT_THAT(mistakes(result), HasSubstr("duration is ")) << text;
  }
}

TEST(ScenarioValues, ReadsAnglesWithTheirUnits) {
  const Scenario scenario =
      loaded(sr1_with("    joints: {RLEG_HIP_R: 0.25, RLEG_HIP_P: 10 deg, RLEG_HIP_Y: 500 mrad, RLEG_KNEE: \"60deg\", "
                      "RLEG_ANKLE_P: -30 deg}\n"));
  ASSERT_EQ(scenario.bodies.size(), 1u);
  const std::vector<double>& joints = scenario.bodies[0].joints;
  EXPECT_EQ(joints[0], 0.25);
  EXPECT_EQ(joints[1], 10 * pi / 180);
  EXPECT_EQ(joints[2], 0.5);
  EXPECT_EQ(joints[3], 60 * pi / 180);
  EXPECT_EQ(joints[4], -30 * pi / 180);
}

TEST(ScenarioValues, TakesEveryFormOfARotation) {
  const Eigen::Quaterniond about_z(Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitZ()));
  for (const char* text : {"[0, 0, 90 deg]", "{axis: [0, 0, 2], angle: 90 deg}", "{quaternion: [3, 0, 0, 3]}"})
    EXPECT_TRUE(rotation_of(text).isApprox(about_z, 1e-15)) << text;
}

TEST(ScenarioValues, RotatesAboutFixedAxesInUrdfsOrder) {
  // Roll turns x stays, y to z; yaw then turns about the world's z: the body's y axis ends up along z, its x along y.
  const Eigen::Quaterniond rotation = rotation_of("[90 deg, 0, 90 deg]");
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_TRUE((rotation * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(ScenarioValues, NormalisesQuaternions) {
  EXPECT_NEAR(rotation_of("{quaternion: [1, 2, 3, 4]}").norm(), 1.0, 1e-15);
}

TEST(ScenarioValues, SharesNodesThroughAnchors) {
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies:\n"
      "  - {name: A, sphere: &small {radius: 0.1}, mass: 1}\n  - {name: B, sphere: *small, mass: 2}\n");
  ASSERT_EQ(scenario.bodies.size(), 2u);
  EXPECT_EQ(std::get<Sphere>(scenario.bodies[1].model->links[0].visuals[0].geometry).radius, 0.1);
}

TEST(ScenarioValues, ReadsAFileWithWindowsLineEndsAndAByteOrderMark) {
  EXPECT_EQ(loaded("\xEF\xBB\xBFrehearse: 1\r\nduration: 3\r\nbodies: [{name: A, sphere: {radius: 1}, mass: 1}]\r\n")
                .duration,
            3.0);
}

TEST(ScenarioValues, CutsLongTextsInMessages) {
  const auto result = load_text(ball_with("time_step: " + std::string(5000, 'x') + "\n"));
  ASSERT_FALSE(result.ok());
  EXPECT_LT(mistakes(result).size(), 400u);
}

struct CommaForPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(ScenarioValues, DoNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new CommaForPoint));
  const double duration = duration_of("2.5");
  const std::string message = mistakes(load_text(ball_with("time_step: 0.5\n")));
  std::locale::global(before);
  EXPECT_EQ(duration, 2.5);
  EXPECT_THAT(message, HasSubstr("time_step is 0.5 (expected a number from 1e-05 to 0.1 [s])"));
}

}  // namespace
}  // namespace rehearse
