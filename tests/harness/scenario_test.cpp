// A scenario as a whole: the fixtures, the defaults, the order and number of its mistakes, its warnings.
#include "scenario_files.h"

#include <rehearse/urdf.h>

#include <gmock/gmock.h>

#include <numbers>

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr double degree = std::numbers::pi / 180.0;

Scenario load_fixture(const std::string& name) {
  Result<Scenario> result = Scenario::load(fixtures / "scenarios" / name);
  EXPECT_TRUE(result.ok()) << mistakes(result);
  return result ? *std::move(result) : Scenario{};
}

TEST(Scenario, TakesTheMemoryOfItsText) {
  const Scenario scenario = load_fixture("sr1_minimum.yaml");
  EXPECT_EQ(scenario.text.size(), std::filesystem::file_size(fixtures / "scenarios/sr1_minimum.yaml"));
  EXPECT_LE(scenario.text.capacity(), 2 * scenario.text.size() + 64);
}

TEST(Scenario, LoadsSr1StandingOnTheFloor) {
  const Scenario scenario = load_fixture("sr1_minimum.yaml");
  EXPECT_EQ(scenario.golden, "SR1.StandsUnderItsMinimumController");
  EXPECT_EQ(scenario.ticks(), 1000);
  ASSERT_EQ(scenario.bodies.size(), 2u);
  const ScenarioBody& floor = scenario.bodies[0];
  EXPECT_TRUE(floor.fixed);
  EXPECT_EQ(floor.position.z() + std::get<Box>(floor.model->links[0].collisions[0].geometry).size.z() / 2, 0.0);
  const ScenarioBody& robot = scenario.bodies[1];
  EXPECT_FALSE(robot.fixed);
  EXPECT_EQ(robot.position, Eigen::Vector3d(0, 0, 0.7135));
  ASSERT_EQ(robot.joints.size(), 29u);
  EXPECT_DOUBLE_EQ(robot.joints[3], 4.50001 * degree);    // RLEG_KNEE
  EXPECT_DOUBLE_EQ(robot.joints[9], -90 * degree);        // RARM_ELBOW
  EXPECT_DOUBLE_EQ(robot.joints[17], -2.40001 * degree);  // LLEG_ANKLE_P
  EXPECT_EQ(robot.joints[26], 0.0);                       // WAIST_P
  EXPECT_EQ(robot.controllers.at(0).library, "SR1MinimumController");
  EXPECT_THAT(scenario.cameras.value(), ElementsAre("SR1/LeftCamera", "SR1/RightCamera"));
  EXPECT_THAT(to_string(scenario.warnings), IsEmpty());
}

TEST(Scenario, LoadsABoxAboveTheFloor) {
  const Scenario scenario = load_fixture("drop_box.yaml");
  EXPECT_EQ(scenario.name, "drop_box");
  ASSERT_EQ(scenario.bodies.size(), 2u);
  EXPECT_FALSE(scenario.bodies[1].fixed);
  EXPECT_EQ(scenario.bodies[1].model->mass(), 2.0);
  EXPECT_THAT(scenario.bodies[1].controllers, IsEmpty());
}

TEST(Scenario, LoadsTheExampleOfTheManual) {
  const std::string manual = read_file(fixtures.parent_path() / "tools/site/pages/reference/scenario.md");
  const std::string fence = "```yaml\n";
  const std::size_t begin = manual.find(fence) + fence.size();
  ASSERT_GT(begin, fence.size());
  std::string example = manual.substr(begin, manual.find("```", begin) - begin);
  const std::size_t models = example.find("../models");
  ASSERT_NE(models, std::string::npos);
  example.replace(models, 9, (fixtures / "models").string());
  const Scenario scenario = loaded(example);
  EXPECT_THAT(to_string(scenario.warnings), IsEmpty());
  EXPECT_EQ(scenario.pushes.size(), 1u);
  EXPECT_EQ(scenario.joystick.value().at(1.0).axes[1], -1.0f);
}

TEST(Scenario, HasTheDefaultsOfChoreonoidWithTheDirectSolver) {
  const Scenario scenario = loaded(ball_with(""));
  EXPECT_EQ(scenario.name, "test");
  EXPECT_EQ(scenario.time_step, 0.001);
  EXPECT_EQ(scenario.gravity, Eigen::Vector3d(0, 0, -9.80665));
  EXPECT_EQ(scenario.seed, 0u);
  EXPECT_EQ(scenario.solver.method, SolverSettings::Method::direct);
  EXPECT_EQ(scenario.solver.iterations, 50);
  EXPECT_EQ(scenario.solver.erp, 0.4);
  EXPECT_EQ(scenario.cameras, std::nullopt);
  EXPECT_TRUE(scenario.record_frames);
  EXPECT_EQ(scenario.look.sky, Look().sky);
}

TEST(Scenario, ReadsTheSettingsOfTheRun) {
  const Scenario scenario =
      loaded(ball_with("name: a ball\nseed: 4294967295\ntime_step: 0.002\ngravity: [0, 1, -2]\n"
                       "options: \"fast\"\ncameras: none\nrecord: {frames: false}\nlook: {sky: [0.5, 0, 1]}\n"
                       "solver: {method: exact, erp: 0.2, max_contacts: 8}\n"));
  EXPECT_EQ(scenario.name, "a ball");
  EXPECT_EQ(scenario.seed, 4294967295u);
  EXPECT_EQ(scenario.ticks(), 500);
  EXPECT_EQ(scenario.gravity, Eigen::Vector3d(0, 1, -2));
  EXPECT_EQ(scenario.options, "fast");
  EXPECT_THAT(scenario.cameras.value(), IsEmpty());
  EXPECT_FALSE(scenario.record_frames);
  EXPECT_EQ(scenario.look.sky, Color(0.5f, 0.0f, 1.0f, 1.0f));
  EXPECT_EQ(scenario.solver.method, SolverSettings::Method::exact);
  EXPECT_EQ(scenario.solver.erp, 0.2);
  EXPECT_EQ(scenario.solver.max_contacts, 8);
}

TEST(Scenario, MayKeepTheGoldensStateAtALowerRate) {
  const auto golden = [](const std::string& value) { return loaded(ball_with("golden: " + value + "\n")); };
  EXPECT_EQ(golden("Ball.Falls").golden_state_rate, std::nullopt);
  EXPECT_EQ(golden("{name: Ball.Falls}").golden, "Ball.Falls");
  EXPECT_EQ(golden("{state: 100 Hz}").golden, "");
  EXPECT_EQ(golden("{state: 100 Hz}").golden_state_rate, 100.0);
  EXPECT_EQ(golden("{state: 500, name: Ball.Falls}").golden_state_rate, 500.0);
}

TEST(Scenario, KeepsItsTextForTheRecord) {
  const std::string text = ball_with("# a remark\n");
  EXPECT_EQ(loaded(text).text, text);
}

TEST(Scenario, ComesFromMemoryWithModelsFromAnywhere) {
  std::vector<std::string> asked;
  const auto source = [&asked](const std::string& file, const UrdfOptions&) -> Result<Model> {
    asked.push_back(file);
    return single_shape_model("made", Sphere{0.1}, 1.0, std::nullopt);
  };
  const std::string text =
      "rehearse: 1\nduration: 1\nbodies: [{name: A, model: m/a.urdf}, {name: B, model: m/a.urdf}]\n";
  const auto result = Scenario::parse(text, "attached.yaml", source);
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_THAT(asked, ElementsAre("m/a.urdf"));
  EXPECT_EQ(result.value().file, "attached.yaml");
  EXPECT_EQ(result.value().text, text);
  EXPECT_EQ(result.value().bodies.at(1).model->name, "made");
}

TEST(Scenario, MayLightItsPictures) {
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nlook: {shadows: true, antialiasing: true, lights: [{position: [1, 2, 3], color: [1, "
      "0.5, 0], "
      "intensity: 2, range: 5}, {position: [0, 0, 2], direction: [0, 0, -1], beam_width: 10 deg, cut_off_angle: 20 "
      "deg}]}\n"
      "bodies: [{name: B, sphere: {radius: 1}, mass: 1}]\n");
  EXPECT_TRUE(scenario.look.shadows);
  EXPECT_TRUE(scenario.look.antialiasing);
  ASSERT_EQ(scenario.look.lights.size(), 2u);
  const SceneLight& bulb = scenario.look.lights[0];
  EXPECT_EQ(bulb.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(bulb.light.color, Eigen::Vector3f(1, 0.5, 0));
  EXPECT_EQ(bulb.light.intensity, 2.0f);
  EXPECT_EQ(bulb.light.range, 5.0);
  EXPECT_FALSE(bulb.light.cone);
  const auto& cone = scenario.look.lights[1].light.cone;
  ASSERT_TRUE(cone);
  EXPECT_EQ(cone->direction, -Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(cone->beam_width, 0.1745, 1e-4);
  EXPECT_NEAR(cone->cut_off_angle, 0.3491, 1e-4);
}

TEST(Scenario, HandsPackagesToTheModelSource) {
  std::map<std::string, std::filesystem::path> asked;
  const auto source = [&asked](const std::string&, const UrdfOptions& options) -> Result<Model> {
    asked = options.packages;
    return single_shape_model("made", Sphere{0.1}, 1.0, std::nullopt);
  };
  const auto result = Scenario::parse(
      "rehearse: 1\nduration: 1\nbodies: [{packages: {arm: ../arm, hand: h}, name: A, model: a.urdf}]\n", "a.yaml",
      source);
  ASSERT_TRUE(result.ok()) << mistakes(result);
  EXPECT_EQ(asked.at("arm"), "../arm");
  EXPECT_EQ(asked.at("hand"), "h");
  EXPECT_EQ(result->bodies[0].packages.size(), 2u);
}

TEST(Scenario, FindsMeshesInItsPackages) {
  const std::string model =
      "<robot name='r'><link name='world'><visual><geometry><mesh "
      "filename='package://things/triangle.stl'/></geometry></visual></link></robot>";
  write_file("r.urdf", model);
  const std::string text = "rehearse: 1\nduration: 1\nbodies:\n  - name: R\n    model: r.urdf\n";
  EXPECT_THAT(mistakes(load_text(text)), testing::HasSubstr("there is no package 'things'"));
  const std::filesystem::path file = write_file("test.yaml", text);
  std::filesystem::create_directory_symlink(fixtures / "broken/meshes", file.parent_path() / "meshes");
  const Scenario scenario = loaded(text + "    packages: {things: meshes}\n");
  EXPECT_EQ(std::get<Mesh>(scenario.bodies.at(0).model->links[0].visuals.at(0).geometry).data->triangle_count(), 1u);
}

TEST(Scenario, TellsWhatAModelSourceLacksAtTheModelsPlace) {
  const auto nothing = [](const std::string&, const UrdfOptions&) -> Result<Model> {
    return error("it isn't attached", "attach it");
  };
  const auto result =
      Scenario::parse("rehearse: 1\nduration: 1\nbodies: [{name: A, model: a.urdf}]\n", "a.yaml", nothing);
  EXPECT_EQ(mistakes(result), "a.yaml:3:27: error: it isn't attached (attach it)\n");
}

TEST(Scenario, CountsTicksByRounding) {
  Scenario scenario;
  scenario.duration = 0.3;  // 0.3 / 0.1 is just below 3
  scenario.time_step = 0.1;
  EXPECT_EQ(scenario.ticks(), 3);
}

TEST(Scenario, ReadsPushes) {
  const Scenario scenario = loaded(ball_with(
      "pushes:\n  - {body: Ball, force: [5, 0, 0], torque: [0, 0, 2], at: [0, 0, 0.1], from: 0.2, until: 0.3}\n"));
  ASSERT_EQ(scenario.pushes.size(), 1u);
  const Push& push = scenario.pushes[0];
  EXPECT_EQ(push.body, 0);
  EXPECT_EQ(push.link, 0);
  EXPECT_EQ(push.force, Eigen::Vector3d(5, 0, 0));
  EXPECT_EQ(push.torque, Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(push.point, Eigen::Vector3d(0, 0, 0.1));
  EXPECT_EQ(push.from, 0.2);
  EXPECT_EQ(push.until, 0.3);
}

TEST(Scenario, ReadsTolerancesInTheOrderOfTheFile) {
  const Scenario scenario =
      loaded(ball_with("tolerances:\n  - {channel: \"*\", atol: 1e-6}\n  - {channel: Ball/*, rtol: 0.1, pixel_share: "
                       "0.01, pixel_delta: 2}\n"));
  ASSERT_EQ(scenario.tolerances.size(), 2u);
  EXPECT_EQ(scenario.tolerances[0].channel, "*");
  EXPECT_EQ(scenario.tolerances[0].atol, 1e-6);
  EXPECT_EQ(scenario.tolerances[0].rtol, std::nullopt);
  EXPECT_EQ(scenario.tolerances[1].rtol, 0.1);
  EXPECT_EQ(scenario.tolerances[1].pixel_share, 0.01);
  EXPECT_EQ(scenario.tolerances[1].pixel_delta, 2.0);
  EXPECT_EQ(scenario.tolerances[1].place.line, 6);
}

TEST(Scenario, ReadsTolerancesInTime) {
  const Scenario scenario = loaded(
      ball_with("tolerances:\n  - {channel: Ball/*, lead: 0.001, lag: 0.002}\n  - {channel: contacts/*, ticks: 3}\n"));
  EXPECT_EQ(scenario.tolerances[0].lead, 0.001);
  EXPECT_EQ(scenario.tolerances[0].lag, 0.002);
  EXPECT_EQ(scenario.tolerances[0].ticks, std::nullopt);
  EXPECT_EQ(scenario.tolerances[1].lead, std::nullopt);
  EXPECT_EQ(scenario.tolerances[1].ticks, 3);
}

TEST(Scenario, TellsAllMistakesInDocumentOrder) {
  const auto result = load_text(
      "rehearse: 1\nduration: -1\npushes: [{body: Nobody, force: [0, 0, 1], from: 0, until: 1}]\n"
      "bodies: [{name: Ball, sphere: {radius: 0}, mass: 1}]\nweather: fine\n");
  ASSERT_FALSE(result.ok());
  ASSERT_EQ(result.errors().size(), 4u) << mistakes(result);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(result.errors()[static_cast<std::size_t>(i)].line, i + 2) << mistakes(result);
}

TEST(Scenario, WritesAMistakeAsCompilersDo) {
  const auto file =
      write_file("run.yaml", "rehearse: 1\nduration: -1\nbodies: [{name: A, sphere: {radius: 1}, mass: 1}]\n");
  EXPECT_EQ(mistakes(Scenario::load(file)),
            file.string() + ":2:11: error: duration is -1 (expected a number above 0 and at most 86400 [s])\n");
}

TEST(Scenario, StopsTellingAtTwentyMistakes) {
  std::string lines;
  for (int i = 0; i < 25; ++i) lines += "key" + std::to_string(i) + ": 1\n";
  const auto result = load_text(ball_with(lines));
  ASSERT_FALSE(result.ok());
  ASSERT_EQ(result.errors().size(), 21u);
  EXPECT_EQ(result.errors()[19].severity, Severity::error);
  EXPECT_THAT(to_string(result.errors()[20]), HasSubstr("note: 5 more errors not shown"));
}

TEST(Scenario, SaysOnlyThatTheVersionIsAnother) {
  const auto result = load_text("rehearse: 2\nlength: 3\n");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.errors().size(), 1u) << mistakes(result);
}

TEST(Scenario, SaysThatTheFileIsMissing) {
  EXPECT_EQ(mistakes(Scenario::load("no/such.yaml")),
            "no/such.yaml: error: there is no such file (expected a scenario, a YAML file)\n");
}

TEST(Scenario, SaysThatTheFileIsADirectory) {
  EXPECT_THAT(mistakes(Scenario::load(fixtures)), HasSubstr("error: it is a directory"));
}

TEST(Scenario, WarnsOfAPushThatNeverComes) {
  const Scenario scenario = loaded(ball_with("pushes: [{body: Ball, force: [1, 0, 0], from: 1, until: 2}]\n"));
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr(":4:47: warning: the push begins at 1 s, after the end"));
}

TEST(Scenario, WarnsOfAPushOnAFixedBody) {
  const Scenario scenario = loaded(
      "rehearse: 1\nduration: 1\nbodies: [{name: Wall, box: {size: [1, 1, 1]}, fixed: true}]\n"
      "pushes: [{body: Wall, force: [1, 0, 0], from: 0, until: 1}]\n");
  EXPECT_THAT(to_string(scenario.warnings), HasSubstr(":4:17: warning: the push does nothing"));
}

}  // namespace
}  // namespace rehearse
