// Public robots, dropped without a controller and held by one that knows nothing about them. They are in a checkout of
// example-robot-data that is named at configure time: cmake -DREHEARSE_EXAMPLE_ROBOTS=DIR. Its files aren't part of
// this repository, so without it these tests are skipped. REHEARSE_ROBOT_TABLE in the environment prints a line per
// run.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rehearse/session.h>
#include <rehearse/trace.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "core/simulation/plant.h"
#include "support/printed_by_name.h"
#include "support/temporary_folder.h"
#include "world/initial_motion.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double gravity = 9.80665;  // [m/s²]

std::string checkout() { return EXAMPLE_ROBOTS; }

struct Robot {
  const char* name;
  const char* kind;
  const char* file;     // below robots/ of the checkout
  double height = 0.0;  // of the root link at the beginning [m]
};

constexpr Robot robots[] = {
    {"Talos", "humanoid", "talos_data/robots/talos_reduced.urdf", 1.2},
    {"Icub", "humanoid", "icub_description/robots/icub.urdf", 0.8},
    {"Anymal", "quadruped", "anymal_c_simple_description/urdf/anymal.urdf", 0.7},
    {"Solo12", "quadruped", "solo_description/robots/solo12.urdf", 0.45},
    {"AllegroHand", "hand", "allegro_hand_description/urdf/allegro_right_hand.urdf", 0.3},
    {"Ur5", "arm", "ur_description/urdf/ur5_robot.urdf", 1.0},
    {"Kinova", "arm with fingers", "kinova_description/robots/kinova.urdf", 1.0},
    {"Panda", "arm with gripper", "panda_description/urdf/panda.urdf", 1.0},
    {"Tiago", "base with arm and hand", "tiago_description/robots/tiago.urdf", 0.2},
    {"Iris", "drone", "iris_description/robots/iris.urdf", 0.5},
    {"Hextilt", "drone with arm", "hextilt_description/urdf/hextilt_flying_arm_5.urdf", 0.8},
};

/// What a run of a robot shows.
struct Figures {
  double energy_begin = 0.0;  // kinetic and potential [J]
  double energy_most = 0.0;   // [J]
  double speed_end = 0.0;     // largest of any link's centre [m/s]
  double speed_most = 0.0;
  double turn_most = 0.0;  // largest angular velocity of any link [rad/s]
  double excess = 0.0;     // largest beyond a joint's limit [rad] or [m]
  double aside = 0.0;      // largest distance of a joint from its initial displacement at the end [rad] or [m]
  double let_go = 0.0;     // likewise, of joints whose drives aren't at their effort limits
};

class PublicRobot : public testing::TestWithParam<Robot> {
 protected:
  PublicRobot() { setenv("REHEARSE_CONTROLLER_PATH", TEST_CONTROLLERS, 1); }
  void SetUp() override {
    if (checkout().empty()) GTEST_SKIP() << "there is no checkout of example-robot-data: -DREHEARSE_EXAMPLE_ROBOTS=DIR";
  }

  /// Two seconds of the robot above or on a floor.
  void run(const std::string& controllers) {
    const fs::path file = folder_ / "run.yaml", trace = folder_ / "run.mcap";
    std::ofstream(file) << fmt::format(
        "rehearse: 1\nduration: 2\ncameras: none\nbodies:\n"
        "  - {{name: Floor, box: {{size: [20, 20, 0.2]}}, fixed: true, position: [0, 0, -0.1]}}\n"
        "  - {{name: Robot, model: {0}/robots/{1}, packages: {{example-robot-data: {0}}}, position: [0, 0, {2}],\n"
        "     controllers: [{3}]}}\n",
        checkout(), GetParam().file, GetParam().height, controllers);
    const auto scenario = Scenario::load(file);
    ASSERT_TRUE(scenario.ok()) << to_string(scenario.errors());
    const auto summary = record(*scenario, trace);
    ASSERT_TRUE(summary.ok()) << to_string(summary.errors());
    EXPECT_FALSE(summary->failure) << summary->failure->message;
    EXPECT_EQ(summary->ticks, scenario->ticks());
    const auto recording = Trace::load(trace);
    ASSERT_TRUE(recording.ok()) << to_string(recording.errors());
    measure(world_bodies(*scenario).at(1), *recording);
  }

  void measure(WorldBody body, const Trace& trace);
  void measure_moment(const WorldBody& body);
  void tell(const std::string& how, const WorldBody& body) const;

  const test::TemporaryFolder folder_;
  Figures figures_;
  double energy_ = 0.0, speed_ = 0.0;  // of the last moment
};

/// The values of a vector's series from `name` + "/x" on; empty if the root is fixed.
std::vector<std::vector<double>> series_of(const Trace& trace, const std::string& name, const std::string& elements) {
  std::vector<std::vector<double>> values;
  for (const char element : elements)
    if (trace.find_series(name + "/" + element)) values.push_back(trace.values(name + "/" + element));
  return values;
}

void PublicRobot::measure(WorldBody body, const Trace& trace) {
  const std::string root = "Robot/" + body.model->links[0].name;
  const auto position = series_of(trace, root + "/position", "xyz"), linear = series_of(trace, root + "/linear", "xyz"),
             angular = series_of(trace, root + "/angular", "xyz"),
             turn = series_of(trace, root + "/orientation", "wxyz");
  std::vector<const Joint*> joints;
  std::vector<std::vector<double>> q, dq;
  for (const int link : body.model->joints) {
    joints.push_back(&body.model->links[static_cast<std::size_t>(link)].joint);
    q.push_back(trace.values("Robot/" + joints.back()->name + "/q"));
    dq.push_back(trace.values("Robot/" + joints.back()->name + "/dq"));
  }
  body.joint_velocities.resize(joints.size());
  const std::size_t ticks = static_cast<std::size_t>(trace.ticks());
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    for (std::size_t id = 0; id < joints.size(); ++id) {
      body.joints[id] = q[id][tick];
      body.joint_velocities[id] = dq[id][tick];
      const double within = std::clamp(q[id][tick], joints[id]->lower, joints[id]->upper);
      figures_.excess = std::max(figures_.excess, std::abs(q[id][tick] - within));
    }
    if (!linear.empty()) {
      body.position = {position[0][tick], position[1][tick], position[2][tick]};
      body.rotation = Eigen::Quaterniond(turn[0][tick], turn[1][tick], turn[2][tick], turn[3][tick]);
      body.linear_velocity = {linear[0][tick], linear[1][tick], linear[2][tick]};
      body.angular_velocity = {angular[0][tick], angular[1][tick], angular[2][tick]};
    }
    measure_moment(body);
    if (tick == 0) figures_.energy_begin = figures_.energy_most = energy_;
    figures_.energy_most = std::max(figures_.energy_most, energy_);
    figures_.speed_most = std::max(figures_.speed_most, speed_);
  }
  figures_.speed_end = speed_;
  for (std::size_t id = 0; id < joints.size(); ++id) {
    const double aside = std::abs(q[id].back() - q[id].front());
    const double effort = std::abs(trace.last("Robot/" + joints[id]->name + "/u"));
    figures_.aside = std::max(figures_.aside, aside);
    if (effort < 0.999 * joints[id]->effort) figures_.let_go = std::max(figures_.let_go, aside);
  }
  EXPECT_LT(figures_.speed_most, 10.0);
  EXPECT_LT(figures_.turn_most, 60.0);
  EXPECT_LT(figures_.energy_most - figures_.energy_begin, 0.05 * body.model->mass() * gravity);
  if (std::getenv("REHEARSE_ROBOT_TABLE")) tell(testing::UnitTest::GetInstance()->current_test_info()->name(), body);
}

void PublicRobot::measure_moment(const WorldBody& body) {
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  root.linear() = body.rotation.toRotationMatrix();
  root.translation() = body.position;
  const auto poses = forward_kinematics(*body.model, root, body.joints);
  const auto motions = initial_motions(body, poses);
  energy_ = speed_ = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Inertial& inertial = body.model->links[i].inertial;
    if (inertial.mass == 0.0) continue;
    const Vector3d spin = poses[i].linear().transpose() * motions[i].angular_velocity;
    const Vector3d arm = poses[i].linear() * inertial.center;
    const Vector3d velocity = motions[i].velocity + motions[i].angular_velocity.cross(arm);
    energy_ += 0.5 * inertial.mass * velocity.squaredNorm() + 0.5 * spin.dot(inertial.inertia * spin) +
               inertial.mass * gravity * (poses[i] * inertial.center).z();
    speed_ = std::max(speed_, velocity.norm());
    figures_.turn_most = std::max(figures_.turn_most, spin.norm());
  }
}

void PublicRobot::tell(const std::string& how, const WorldBody& body) const {
  std::cout << fmt::format(
      "| {} | {} | {} | {} | {:.3g} | {} | {:.3g} | {:.3g} | {:+.2g} | {:.2g} | {:.2g} | {:.2g} |\n", GetParam().name,
      GetParam().kind, body.model->links.size(), body.model->joints.size(), body.model->mass(), how,
      figures_.speed_most, figures_.turn_most, figures_.energy_most - figures_.energy_begin, figures_.speed_end,
      figures_.excess, figures_.aside);
}

TEST_P(PublicRobot, IsDropped) { run(""); }

TEST_P(PublicRobot, IsHeld) {
  run("{library: Behaviours, options: posture}");
  EXPECT_LT(figures_.let_go, 0.15);
}

INSTANTIATE_TEST_SUITE_P(All, PublicRobot, testing::ValuesIn(robots), test::by_name);

}  // namespace
}  // namespace rehearse
