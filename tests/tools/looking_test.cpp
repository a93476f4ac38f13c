// The verbs that inspect: info with traces, inspect with models, render with scenes.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "command.h"
#include "picture/picture.h"

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Info : public Command {};
class Inspect : public Command {};
class Render : public Command {
 protected:
  Image picture(const std::string& name) const {
    const std::string bytes = read_file(folder() / name);
    const Result<Image> image = decode_png({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    EXPECT_TRUE(image.ok());
    return image ? *image : Image{};
  }
};

TEST_F(Info, TellsAPersonWhatIsInATrace) {
  done({"record", sr1_scenario.string(), "--duration", "0.2", "-o", "sr1.mcap"});
  const std::string text = done({"info", "sr1.mcap"}).out;
  EXPECT_THAT(
      text,
      ContainsRegex(
          "^file +sr1.mcap\nsize +.*\nlibrary +rehearse " REHEARSE_VERSION
          "\nprofile +ros2\nmessages +[0-9]+ in 21 channels\nticks +200\n"
          "duration +0.2 s\nstart +0 s\nend +0.2 s\ncompression +none: [0-9]+ chunks?, .*\n +zstd: [0-9]+ chunks?, "));
  EXPECT_THAT(text, ContainsRegex("\n  /SR1/joints  +sensor_msgs/msg/JointState  +cdr  +201  +1000 Hz  +"));
  EXPECT_THAT(text, HasSubstr("\n  scenario.yaml, application/yaml, "));
  EXPECT_THAT(text, HasSubstr("\n  seed: 0\n"));
  EXPECT_THAT(text, HasSubstr("\nmetadata 'rehearse.outcome'\n  checkpoints: exact\n  complete: true\n"));
}

TEST_F(Info, TellsAProgramAllOfIt) {
  done({"record", sr1_scenario.string(), "--duration", "0.1", "-o", "sr1.mcap"});
  const nlohmann::json info = done({"info", "sr1.mcap", "--json"}).json();
  EXPECT_EQ(info["header"]["profile"], "ros2");
  EXPECT_EQ(info["size"], fs::file_size(folder() / "sr1.mcap"));
  EXPECT_EQ(info["duration"], 0.1);
  ASSERT_EQ(info["channels"].size(), 21u);
  EXPECT_EQ(info["channels"][0]["topic"], "/SR1/joints");
  EXPECT_EQ(info["channels"][0]["type"], "sensor_msgs/msg/JointState");
  EXPECT_EQ(info["channels"][0]["messages"], 101);
  EXPECT_NEAR(info["channels"][0]["rate"], 1000.0, 1e-6);
  EXPECT_EQ(info["statistics"]["message_count"], info["messages"]);
  EXPECT_EQ(info["attachments"][0]["name"], "scenario.yaml");
  EXPECT_EQ(info["attachments"][0]["size"], fs::file_size(sr1_scenario));
  EXPECT_EQ(info["metadata"][0]["name"], "rehearse");
  EXPECT_FALSE(info["schemas"].empty());
  EXPECT_TRUE(info["damage"].empty());
}

TEST_F(Info, ShowsWhatIsWholeOfATruncatedTraceAndSaysSo) {
  done({"record", box_scenario.string(), "-o", "box.mcap"});
  fs::resize_file(folder() / "box.mcap", fs::file_size(folder() / "box.mcap") - 100);
  const Outcome outcome = rehearse({"info", "box.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.out, HasSubstr("/Box/"));
  EXPECT_THAT(outcome.err, StartsWith("box.mcap: error: truncated at byte "));
  const Outcome json = rehearse({"info", "box.mcap", "--json"});
  EXPECT_EQ(json.status, 2);
  EXPECT_EQ(json.err, "");
  EXPECT_FALSE(json.json()["damage"].empty());
}

const std::string sr1_model = (fixtures / "models/sr1.urdf").string();

TEST_F(Inspect, TellsAPersonWhatWasUnderstood) {
  const std::string text = done({"inspect", sr1_model}).out;
  EXPECT_THAT(text, StartsWith("SR1: 30 links, 29 joints (29 revolute), 7 devices, "));
  EXPECT_THAT(text, ContainsRegex("\n  3   RLEG_KNEE +revolute +RLEG_KNEE +0 to 2.618 rad +500 N·m\n"));
  EXPECT_THAT(text, ContainsRegex("\n  1   RightAnkleForceSensor  ForceSensor +RLEG_ANKLE_R\n"));
  EXPECT_THAT(text, ContainsRegex("sr1.urdf:[0-9]+: note: "));
}

TEST_F(Inspect, TellsAProgramAllOfIt) {
  const nlohmann::json model = done({"inspect", sr1_model, "--json"}).json();
  EXPECT_EQ(model["name"], "SR1");
  ASSERT_EQ(model["links"].size(), 30u);
  ASSERT_EQ(model["joints"].size(), 29u);
  ASSERT_EQ(model["devices"].size(), 7u);
  for (const char* kind : {"links", "joints", "devices"})
    for (const nlohmann::json& object : model[kind]) {
      EXPECT_TRUE(object["name"].is_string() && object["type"].is_string()) << object;
    }
  const nlohmann::json& knee = model["joints"][3];
  EXPECT_EQ(knee["name"], "RLEG_KNEE");
  EXPECT_EQ(knee["type"], "revolute");
  EXPECT_EQ(knee["id"], 3);
  EXPECT_EQ(knee["parent"], "RLEG_HIP_Y");
  EXPECT_EQ(knee["limits"]["effort"], 500.0);
  const nlohmann::json& waist = model["links"][0];
  EXPECT_EQ(waist["center"], nlohmann::json({0.0, 0.0, 0.0375}));
  EXPECT_EQ(waist["inertia"], nlohmann::json({1.0, 1.0, 1.0, 0.0, 0.0, 0.0}));
  const nlohmann::json& hip = model["links"][1];
  EXPECT_EQ(hip["name"], "RLEG_HIP_R");
  EXPECT_EQ(hip["position"], nlohmann::json({0.0, -0.09, 0.0}));
  EXPECT_EQ(hip["quaternion"], nlohmann::json({1.0, 0.0, 0.0, 0.0}));
  double mass = 0.0;
  for (const nlohmann::json& link : model["links"]) mass += link["mass"].get<double>();
  EXPECT_NEAR(model["mass"], mass, 1e-9);
  EXPECT_EQ(model["findings"][0]["severity"], "note");
  EXPECT_GT(model["findings"][0]["line"], 0);
}

const std::string mesh_model = (fixtures / "models/mesh_arm/mesh_arm.urdf").string();

TEST_F(Inspect, CountsMeshesAndTriangles) {
  EXPECT_THAT(done({"inspect", mesh_model}).out,
              HasSubstr("\n7 mesh files: 7 visuals with 1944 triangles, 4 collisions with 600 triangles\n"));
  const nlohmann::json model = done({"inspect", mesh_model, "--json"}).json();
  ASSERT_EQ(model["meshes"].size(), 7u);
  EXPECT_EQ(model["meshes"][0]["file"], "meshes/base.dae");
  EXPECT_EQ(model["meshes"][6]["file"], "package://mesh_arm/meshes/finger.stl");
  EXPECT_EQ(model["meshes"][6]["uses"], 4);
  EXPECT_EQ(model["meshes"][6]["triangles"], 44);
  EXPECT_EQ(model["triangles"]["visuals"], 1944);
  EXPECT_EQ(model["triangles"]["collisions"], 600);
  EXPECT_THAT(done({"inspect", sr1_model}).out, ::testing::Not(HasSubstr("mesh file")));
}

TEST_F(Inspect, TakesTheDirectoriesOfPackages) {
  std::string text = read_file(mesh_model);
  for (std::size_t at = 0; (at = text.find("package://mesh_arm/meshes/", at)) != std::string::npos;)
    text.replace(at, 26, "package://things/");
  text.replace(text.find("meshes/base.dae"), 15, "package://base%20of/base.dae");
  std::ofstream(folder() / "arm.urdf") << text;
  const Outcome refused = rehearse({"inspect", "arm.urdf"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, ContainsRegex("arm.urdf:[0-9]+: error: the mesh 'package://things/shoulder.stl' can't be "
                                         "used: there is no package 'things' .say where the package is: --package"));
  const std::string meshes = (fixtures / "models/mesh_arm/meshes").string();
  const Outcome outcome =
      done({"inspect", "arm.urdf", "--package", "things=" + meshes, "--package", "base%20of=" + meshes});
  EXPECT_THAT(outcome.out, HasSubstr("\n7 mesh files: "));
  EXPECT_EQ(rehearse({"inspect", "arm.urdf", "--package", "things"}).status, 2);
  EXPECT_EQ(rehearse({"inspect", "arm.urdf", "--package", "a=b", "--package", "a=c"}).status, 2);
}

TEST_F(Inspect, LeavesMissingMeshesOutIfItMay) {
  const std::string broken = (fixtures / "broken/urdf_mesh_absent.urdf").string();
  EXPECT_EQ(rehearse({"inspect", broken}).status, 2);
  EXPECT_THAT(done({"inspect", broken, "--allow-missing-meshes"}).out,
              ContainsRegex(":5: warning: the mesh 'meshes/absent.stl' can't be used: it isn't there; its shape is "));
}

TEST_F(Inspect, TellsWhichSensorsAScenarioAdds) {
  std::ofstream(folder() / "late.yaml") << "rehearse: 1\nduration: 1\nbodies:\n  - name: Robot\n    model: " +
                                               sr1_model + "\n    sensors: [{name: Back, type: imu, link: CHEST}]\n";
  const std::string text = done({"inspect", "--scenario", "late.yaml"}).out;
  EXPECT_THAT(text,
              StartsWith("body Robot, of " + sr1_model + "\nSR1: 30 links, 29 joints (29 revolute), 8 devices, "));
  EXPECT_THAT(text, ContainsRegex("\n  -   Back +Imu +CHEST +scenario\n"));
  EXPECT_THAT(text, ContainsRegex("\n  1   RightAnkleForceSensor  ForceSensor +RLEG_ANKLE_R +model\n"));
  const nlohmann::json bodies = done({"inspect", "--scenario", "late.yaml", "--json"}).json()["bodies"];
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0]["body"], "Robot");
  EXPECT_EQ(bodies[0]["model"]["devices"].size(), 8u);
  EXPECT_EQ(rehearse({"inspect"}).status, 2);
  EXPECT_EQ(rehearse({"inspect", sr1_model, "--scenario", "late.yaml"}).status, 2);
  EXPECT_THAT(rehearse({"inspect", "--scenario", (fixtures / "broken/scenario_sensor_unknown_link.yaml").string()}).err,
              HasSubstr("Arm has no link 'rods'"));
}

class Actuators : public Command {};

TEST_F(Actuators, OfAMuJoCoModelAreThoseOfAScenario) {
  std::ofstream(folder() / "leg.xml") << R"(<mujoco><default><joint damping="0.5"/></default>
    <worldbody><body><joint name="hinge" armature="0.01"/></body></worldbody>
    <actuator><position joint="hinge" kp="40" kv="2" forcerange="-9 9"/></actuator></mujoco>)";
  const std::string block = done({"actuators", "leg.xml"}).out;
  EXPECT_EQ(block,
            "actuators:\n  - {joint: hinge, effort: 9, armature: 0.01, damping: 0.5, position_gain: 40, velocity_gain: "
            "2}\n");
  std::string indented = "    " + block;
  indented.replace(indented.find("\n  -"), 1, "\n    ");
  std::ofstream(folder() / "leg.yaml") << "rehearse: 1\nduration: 0.01\nbodies:\n  - name: Leg\n    model: " +
                                              (fixtures / "models/pendulum.urdf").string() + "\n" + indented;
  done({"inspect", "--scenario", "leg.yaml"});
  EXPECT_EQ(rehearse({"actuators", sr1_model}).status, 2);
}

TEST_F(Inspect, TellsAPersonEveryErrorOfABrokenModel) {
  const Outcome outcome = rehearse({"inspect", (fixtures / "broken/urdf_axis_zero.urdf").string()});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, ContainsRegex("urdf_axis_zero.urdf:[0-9]+:?[0-9]*: error: "));
}

TEST_F(Inspect, TellsAProgramTheErrorsAsFindings) {
  const Outcome outcome = rehearse({"inspect", (fixtures / "broken/urdf_axis_zero.urdf").string(), "--json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "");
  const nlohmann::json model = outcome.json();
  EXPECT_EQ(model["name"], nullptr);
  ASSERT_FALSE(model["findings"].empty());
  EXPECT_EQ(model["findings"][0]["severity"], "error");
}

TEST_F(Inspect, GivesLinksWithoutMassADefaultOnRequest) {
  const std::string arm = (fixtures / "broken/urdf_moving_without_mass.urdf").string();
  EXPECT_EQ(rehearse({"inspect", arm}).status, 2);
  const nlohmann::json model = done({"inspect", arm, "--default-mass", "2.5", "--json"}).json();
  EXPECT_EQ(model["mass"], 2.5);
  EXPECT_EQ(model["findings"][0]["severity"], "repair");
  EXPECT_EQ(model["findings"][0]["file"], arm);
  EXPECT_EQ(model["findings"][0]["line"], 9);
  EXPECT_EQ(rehearse({"inspect", arm, "--default-mass", "2.5", "--strict"}).status, 2);
}

TEST_F(Render, DrawsAScenarioAsItStarts) {
  EXPECT_THAT(done({"render", sr1_scenario.string(), "-o", "sr1.png"}).out,
              StartsWith("sr1.png: 960 x 720 pixels, seen from "));
  const Image image = picture("sr1.png");
  ASSERT_EQ(image.width, 960);
  ASSERT_EQ(image.height, 720);
  // the robot's light grey is in the middle of the picture, and not at its edges
  int middle = 0, edge = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* pixel = &image.pixels[3 * (static_cast<std::size_t>(y) * image.width + x)];
      const bool grey = pixel[0] > 150 && pixel[2] - pixel[0] < 20;
      const bool inside = x > 240 && x < 720 && y > 10 && y < 710;
      (inside ? middle : edge) += grey ? 1 : 0;
    }
  EXPECT_GT(middle, 10'000);
  EXPECT_EQ(edge, 0);
}

TEST_F(Render, DrawsAModelInTheAskedSize) {
  done({"render", sr1_model, "-o", "sr1.png", "--width", "200", "--height", "300"});
  EXPECT_EQ(picture("sr1.png").width, 200);
  EXPECT_EQ(picture("sr1.png").height, 300);
}

TEST_F(Render, LooksFromWhereItIsTold) {
  const Outcome outcome = done({"render", box_scenario.string(), "-o", "a.png", "--eye", "-2,1.5,1", "--target",
                                "0,0,0.6", "--fov", "20", "--width", "99", "--height", "99"});
  EXPECT_THAT(outcome.out, HasSubstr("seen from -2,1.5,1 m towards 0,0,0.6 m"));
  const Image image = picture("a.png");
  const std::uint8_t* pixel = &image.pixels[3 * (49 * 99 + 49)];
  EXPECT_GT(pixel[0], 2 * pixel[2]);  // the orange box is in the middle
}

TEST_F(Render, ShowsTheLookOfTheScenario) {
  std::ofstream(folder() / "look.yaml")
      << "rehearse: 1\nduration: 1\nlook: {sky: [0, 1, 0]}\nbodies:\n"
         "  - name: Board\n    fixed: true\n"
         "    box: {size: [1, 1, 0.2], color: [1, 0, 0], checker: {color: [0, 0, 1], size: 0.5}}\n";
  done({"render", "look.yaml", "-o", "a.png", "--eye", "0,0,2", "--target", "0,0,0", "--fov", "50", "--width", "100",
        "--height", "100"});
  const Image image = picture("a.png");
  const auto strongest = [&image](std::size_t x, std::size_t y) {
    const auto pixel = image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * (100 * y + x));
    return std::max_element(pixel, pixel + 3) - pixel;
  };
  EXPECT_EQ(strongest(5, 5), 1) << "the sky";
  EXPECT_EQ(strongest(60, 40), 0) << "x and y are positive";
  EXPECT_EQ(strongest(40, 60), 0) << "x and y are negative";
  EXPECT_EQ(strongest(40, 40), 2);
  EXPECT_EQ(strongest(60, 60), 2);
}

TEST_F(Render, FindsMeshesWhereItIsTold) {
  const std::string model = (fixtures / "models/mesh_arm/mesh_arm.urdf").string();
  std::string text = read_file(model);
  for (std::size_t at = 0; (at = text.find("package://mesh_arm/", at)) != std::string::npos;)
    text.replace(at, 19, "package://elsewhere/");
  std::ofstream(folder() / "arm.urdf") << text;
  EXPECT_THAT(rehearse({"render", "arm.urdf", "-o", "a.png"}).err, HasSubstr("there is no package 'elsewhere'"));
  fs::create_directory_symlink(fixtures / "models/mesh_arm/meshes", folder() / "meshes");  // of relative paths
  done({"render", "arm.urdf", "-o", "a.png", "--package", "elsewhere=" + (fixtures / "models/mesh_arm").string()});
  done({"render", model, "-o", "b.png"});
  EXPECT_TRUE(read_file(folder() / "a.png") == read_file(folder() / "b.png"));
  fs::remove(folder() / "meshes");
  done({"render", "arm.urdf", "-o", "c.png", "--allow-missing-meshes"});
  EXPECT_FALSE(read_file(folder() / "c.png") == read_file(folder() / "b.png")) << "only what could be had is drawn";
}

TEST_F(Render, DrawsTheShapesThatTouchIfAsked) {
  std::ofstream(folder() / "ball.urdf")
      << "<robot name='ball'><link name='BALL'>"
         "<visual><geometry><box size='0.1 0.1 0.1'/></geometry><material name='m'><color rgba='0 0 1 1'/></material>"
         "</visual><collision><origin xyz='0 0.3 0'/><geometry><sphere radius='0.1'/></geometry></collision>"
         "</link></robot>";
  const std::vector<std::string> words{"render", "ball.urdf", "-o", "seen.png", "--eye", "2,0,0",    "--target",
                                       "0,0,0",  "--fov",     "25", "--width",  "100",   "--height", "100"};
  done(words);
  std::vector<std::string> asked = words;
  asked[3] = "touched.png";
  asked.push_back("--collision");
  done(asked);
  // y is 0.887 m wide at a distance of 2 m: the box is in the middle, the ball 34 pixels to the right of it
  const auto color = [&](const char* file, std::size_t x) {
    const Image image = picture(file);
    const std::uint8_t* pixel = &image.pixels[3 * (50 * 100 + x)];
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  const auto sky = color("seen.png", 84);
  EXPECT_LT(color("seen.png", 50)[0], 60) << "the blue box";
  EXPECT_NE(color("touched.png", 84), sky) << "the ball";
  EXPECT_GT(color("touched.png", 50)[0], 100) << "no box";
}

TEST_F(Render, DrawsJointsWhereTheyCanBe) {
  std::ofstream(folder() / "arm.urdf")
      << "<robot name='r'>"
      << "<link name='a'/>"
      << "<link name='b'><visual><geometry><sphere radius='0.1'/></geometry></visual></link>"
      << "<joint name='slide' type='prismatic'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/>"
      << "<limit lower='2' upper='3' effort='1' velocity='1'/></joint></robot>";
  EXPECT_THAT(done({"render", "arm.urdf", "-o", "a.png"}).out, ContainsRegex("towards .*,2 m")) << "not at 0";
}

TEST_F(Render, GivesTheSamePictureTwice) {
  for (const char* file : {"a.png", "b.png"}) done({"render", sr1_scenario.string(), "-o", file});
  EXPECT_TRUE(read_file(folder() / "a.png") == read_file(folder() / "b.png"));
}

}  // namespace
}  // namespace rehearse::test
