// Reports of the goldens: the robots in them move as recorded, and the files are small enough.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/report.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <Eigen/Geometry>
#include <bit>
#include <fstream>
#include <map>

#include "../small_traces.h"
#include "core/scenario/trace_scenario.h"
#include "decoded_report.h"

namespace rehearse::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

namespace fs = std::filesystem;

const fs::path goldens = fs::path(FIXTURES_DIR).parent_path() / "golden";

class ReportOfAGolden : public ::testing::TestWithParam<const char*> {
 protected:
  DecodedReport written(const fs::path& trace, const std::optional<fs::path>& golden = std::nullopt) {
    ReportOptions options;
    options.page = plain_page(folder_ / "page.html");
    const auto summary = write_report(trace, golden, folder_ / "report.html", options);
    EXPECT_TRUE(summary) << (summary ? "" : to_string(summary.errors()));
    if (summary) summary_ = *summary;
    return DecodedReport(folder_ / "report.html");
  }

  TemporaryFolder folder_;
  ReportSummary summary_;
};

Eigen::Isometry3d pose_of(const std::vector<double>& numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]));
  pose.rotate(Eigen::Quaterniond(numbers[6], numbers[3], numbers[4], numbers[5]));
  return pose;
}

/// Values of a series by tick, from the report alone.
class Motion {
 public:
  explicit Motion(const DecodedReport& report) : report_(report) {}

  double at(const std::string& name, std::int64_t tick) {
    auto known = series_.find(name);
    if (known == series_.end()) {
      const Json& series = report_.series(name);
      std::map<std::int64_t, double> values;
      const auto bits = report_.values(series);
      const auto ticks = report_.ticks(series["axis"]);
      for (std::size_t i = 0; i < bits.size(); ++i) values[ticks[i]] = std::bit_cast<double>(bits[i]);
      known = series_.emplace(name, std::move(values)).first;
    }
    return known->second.at(tick);
  }

  /// Poses of all links in the world, computed according to FORMAT.md.
  std::vector<Eigen::Isometry3d> poses(const Json& robot, std::int64_t tick) {
    std::vector<Eigen::Isometry3d> poses;
    for (const Json& link : robot["links"]) {
      if (link["parent"] == -1) {
        std::vector<double> numbers;
        if (link["pose"].is_null())
          numbers = link["fixed"].get<std::vector<double>>();
        else
          for (const Json& name : link["pose"]) numbers.push_back(at(name, tick));
        poses.push_back(pose_of(numbers));
        continue;
      }
      if (link.contains("pose") && !link["pose"].is_null()) {  // behind a floating joint
        std::vector<double> numbers;
        for (const Json& name : link["pose"]) numbers.push_back(at(name, tick));
        poses.push_back(pose_of(numbers));
        continue;
      }
      Eigen::Isometry3d pose = poses.at(link["parent"].get<std::size_t>()) * pose_of(link["offset"]);
      const Json& joint = link["joint"];
      const double q = joint["q"].is_null() ? joint["q0"].get<double>() : at(joint["q"], tick);
      const std::vector<double> axis = joint["axis"];
      if (joint["type"] == "revolute") pose.rotate(Eigen::AngleAxisd(q, Eigen::Vector3d(axis[0], axis[1], axis[2])));
      if (joint["type"] == "prismatic") pose.translate(q * Eigen::Vector3d(axis[0], axis[1], axis[2]));
      poses.push_back(pose);
    }
    return poses;
  }

 private:
  const DecodedReport& report_;
  std::map<std::string, std::map<std::int64_t, double>> series_;
};

/// The recorded pose of a link at that row of /tf.
Eigen::Isometry3d recorded_pose(const TraceChannel& frames, std::size_t row, const std::string& frame) {
  std::vector<double> numbers;
  for (const char* element : {"/position/x", "/position/y", "/position/z", "/orientation/x", "/orientation/y",
                              "/orientation/z", "/orientation/w"}) {
    for (std::size_t c = 0; c < frames.columns.size(); ++c)
      if (frames.columns[c].element == frame + element) numbers.push_back(frames.number(row, c));
  }
  EXPECT_EQ(numbers.size(), 7u) << frame;
  return numbers.size() == 7 ? pose_of(numbers) : Eigen::Isometry3d::Identity();
}

/// True if joints hold the link to its root; false behind a floating joint.
bool is_held(const Model& model, std::size_t link) {
  for (int at = static_cast<int>(link); at > 0; at = model.links[static_cast<std::size_t>(at)].parent)
    if (model.links[static_cast<std::size_t>(at)].joint.type == JointType::free) return false;
  return true;
}

void expect_near(const Eigen::Isometry3d& pose, const Eigen::Isometry3d& expected, double bound,
                 const std::string& what) {
  EXPECT_LT((pose.translation() - expected.translation()).norm(), bound) << what;
  EXPECT_LT((pose.linear() - expected.linear()).norm(), bound) << what;
}

/// The links of the report's robots are where the recording has them, by its joints and by /tf.
void expect_recorded_motion(const DecodedReport& report, const fs::path& file) {
  const auto trace = Trace::load(file);
  ASSERT_TRUE(trace);
  const auto scenario = recorded_scenario(*trace);
  ASSERT_TRUE(scenario);
  const TraceChannel* frames = trace->find_channel("/tf");
  ASSERT_NE(frames, nullptr);
  ASSERT_EQ(report["robots"].size(), scenario->bodies.size());
  Motion motion(report);
  for (std::size_t row = 0; row < frames->rows(); ++row) {
    const std::int64_t tick = std::llround(static_cast<double>(frames->times[row]) / 1e9 / scenario->time_step);
    for (std::size_t body = 0; body < scenario->bodies.size(); ++body) {
      const Model& model = *scenario->bodies[body].model;
      const auto poses = motion.poses(report["robots"][body], tick);
      std::vector<double> q;
      for (const int link : model.joints)
        q.push_back(motion.at(
            scenario->bodies[body].name + "/" + model.links[static_cast<std::size_t>(link)].joint.name + "/q", tick));
      const auto by_engine = forward_kinematics(model, poses[0], q);
      ASSERT_EQ(poses.size(), by_engine.size());
      for (std::size_t link = 0; link < poses.size(); ++link) {
        const std::string frame = scenario->bodies[body].name + "/" + model.links[link].name;
        if (is_held(model, link))
          expect_near(poses[link], by_engine[link], 1e-9, frame + " at " + std::to_string(tick));
        // a solver keeps joints together only nearly: from the second tick on links stray by up to 0.1 mm
        expect_near(poses[link], recorded_pose(*frames, row, frame), tick == 0 ? 1e-9 : 2e-4,
                    frame + " at " + std::to_string(tick));
      }
    }
  }
}

TEST_P(ReportOfAGolden, MovesTheLinksAsTheyWereRecorded) {
  const fs::path file = goldens / GetParam();
  expect_recorded_motion(written(file), file);
}

using ReportOfAFloatingJoint = ReportOfAGolden;

TEST_F(ReportOfAFloatingJoint, MovesTheLinksBehindItAsTheyWereRecorded) {
  std::ofstream(folder_ / "thrown.urdf")
      << "<robot name='thrown'><link name='world'/><link name='BASE'/>"
         "<joint name='mount' type='fixed'><parent link='world'/><child link='BASE'/></joint>"
         "<joint name='loose' type='floating'><parent link='BASE'/><child link='BLOCK'/><origin xyz='0 0 2'/></joint>"
         "<link name='BLOCK'><inertial><mass value='2'/><inertia ixx='0.02' iyy='0.03' izz='0.04' ixy='0' ixz='0' "
         "iyz='0'/></inertial><visual><geometry><box size='0.3 0.2 0.1'/></geometry></visual></link>"
         "<joint name='hinge' type='revolute'><parent link='BLOCK'/><child link='LID'/><origin xyz='0.1 0 0'/>"
         "<axis xyz='0 1 0'/><limit lower='-2' upper='2' effort='1' velocity='9'/></joint>"
         "<link name='LID'><inertial><origin xyz='0.1 0 0'/><mass value='1'/><inertia ixx='0.01' iyy='0.01' "
         "izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
  std::ofstream(folder_ / "thrown.yaml")
      << "rehearse: 1\nduration: 0.3\nbodies: [{name: Robot, model: thrown.urdf}]\n"
         "pushes: [{body: Robot, link: BLOCK, force: [20, 0, 0], torque: [0, 0, 1], from: 0, until: 0.2}]\n";
  const auto scenario = Scenario::load(folder_ / "thrown.yaml");
  ASSERT_TRUE(scenario) << to_string(scenario.errors());
  ASSERT_TRUE(record(*scenario, folder_ / "thrown.mcap"));
  const DecodedReport report = written(folder_ / "thrown.mcap");
  expect_recorded_motion(report, folder_ / "thrown.mcap");
  Motion motion(report);
  const auto begin = motion.poses(report["robots"][0], 0), end = motion.poses(report["robots"][0], 300);
  EXPECT_GT((end.back().translation() - begin.back().translation()).norm(), 0.2) << "it fell, and was pushed";
}

TEST_P(ReportOfAGolden, IsNotMuchLargerThanItsTraces) {
  const fs::path file = goldens / GetParam();
  const double size = static_cast<double>(fs::file_size(file));
  written(file);
  EXPECT_LT(static_cast<double>(summary_.data_bytes), 1.5 * size);
  written(file, file);
  EXPECT_LT(static_cast<double>(summary_.data_bytes), 1.5 * size);  // the golden is the same
}

// A biped of boxes with cameras, an arm of meshes, a quadruped, and a camera on a head.
INSTANTIATE_TEST_SUITE_P(All, ReportOfAGolden,
                         ::testing::Values("SR1.StandsUnderItsMinimumController.mcap", "Grasp.CarriesABlockAside.mcap",
                                           "CameraFollower.KeepsTheBallInTheMiddle.mcap"),
                         [](const auto& of) {
                           const std::string name = of.param;
                           return name.substr(0, name.find('.'));
                         });

class ReportOfMeshes : public ReportOfAGolden {};

const Json& robot(const DecodedReport& report, const std::string& name) {
  static const Json none;
  for (const Json& robot : report["robots"])
    if (robot["name"] == name) return robot;
  return none;
}

TEST_F(ReportOfMeshes, HasTheirTriangles) {
  const DecodedReport report = written(goldens / "Grasp.CarriesABlockAside.mcap");
  EXPECT_THAT(summary_.omitted, IsEmpty());
  std::size_t shapes = 0;
  for (const Json& link : robot(report, "Arm")["links"]) {
    for (const Json& shape : link["shapes"]) {
      if (!shape.contains("mesh")) continue;
      ++shapes;
      const Json& mesh = report["meshes"].at(shape["mesh"].get<std::size_t>());
      const std::size_t vertices = report.numbers(mesh["positions"]).size() / 12;
      const auto indices = report.numbers(mesh["indices"]);
      EXPECT_GT(vertices, 0u);
      EXPECT_EQ(indices.size() % 12, 0u);
      for (std::size_t i = 0; i < indices.size(); i += 4) {
        std::uint32_t index = 0;
        std::memcpy(&index, &indices[i], 4);
        ASSERT_LT(index, vertices);
      }
      if (mesh.contains("color")) {
        EXPECT_EQ(report.numbers(mesh["color"]).size(), 4 * vertices);
      }
    }
  }
  EXPECT_GT(shapes, 3u);
}

TEST_F(ReportOfMeshes, ThatAreNotThereHasSomethingSimplerAndSaysSo) {
  fs::copy_file(goldens / "Grasp.CarriesABlockAside.mcap", folder_ / "grasp.mcap");
  fs::create_directory(folder_ / "elsewhere");
  ReportOptions options;
  options.page = plain_page(folder_ / "page.html");
  options.scenario = folder_ / "elsewhere/mesh_arm.yaml";
  const auto summary = write_report(folder_ / "grasp.mcap", std::nullopt, folder_ / "report.html", options);
  ASSERT_TRUE(summary) << to_string(summary.errors());
  EXPECT_THAT(summary->omitted, Contains(HasSubstr("of Arm can't be found on this machine")));
  const DecodedReport report(folder_ / "report.html");
  EXPECT_THAT(report["meshes"], SizeIs(0));
  for (const Json& link : robot(report, "Arm")["links"])
    for (const Json& shape : link["shapes"]) EXPECT_FALSE(shape.contains("mesh"));
}

TEST_F(ReportOfMeshes, ThatHaveChangedSaysSo) {
  const fs::path models = fs::path(FIXTURES_DIR) / "models";
  fs::create_directories(folder_ / "scenarios");
  fs::create_directories(folder_ / "models");
  fs::copy(models / "mesh_arm", folder_ / "models/mesh_arm", fs::copy_options::recursive);
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "models/mesh_arm"))
    if (entry.path().extension() == ".stl") std::ofstream(entry.path(), std::ios::app | std::ios::binary) << '\n';
  ReportOptions options;
  options.page = plain_page(folder_ / "page.html");
  options.scenario = folder_ / "scenarios/mesh_arm.yaml";
  const auto summary =
      write_report(goldens / "Grasp.CarriesABlockAside.mcap", std::nullopt, folder_ / "report.html", options);
  ASSERT_TRUE(summary) << to_string(summary.errors());
  EXPECT_THAT(summary->omitted, Contains(HasSubstr("changed after the recording")));
}

TEST_F(ReportOfMeshes, OfAnotherScenarioThanItsGoldensSaysSo) {
  const DecodedReport report =
      written(goldens / "Spring.SwingsWithItsNaturalFrequency.mcap", goldens / "PendulumSwingUp.EndsUpright.mcap");
  EXPECT_EQ(report["verdict"]["state"], "beyond");
  EXPECT_THAT(report["runs"][1]["remarks"], Contains(HasSubstr("it is of another scenario: pendulum_swing_up")));
}

}  // namespace
}  // namespace rehearse::testing
