// SR1 squats along a motion from a .seq file.
#include <rehearse/gtest.h>
#include <rehearse/urdf.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using rehearse::Trace;

constexpr double gravity = 9.80665;              // [m/s²]
constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double lowest = 1.3;                   // when it is lowest [s]
constexpr double end = 2.55;                     // [s]

// The motion is that of this build, whatever share folder the user has for other controllers.
const bool has_no_other_share_folder = unsetenv("REHEARSE_CHOREONOID_SHARE") == 0;

const Trace& squat() {
  static const Trace trace = rehearse::record("scenarios/sr1_squat.yaml");
  return trace;
}

const rehearse::Model& sr1() {
  static const auto model = rehearse::load_urdf(rehearse::fixture_path("models/sr1.urdf"));
  return model.value();
}

/// All links at a time, from the waist's pose and the joints.
std::vector<Isometry3d> links(double time) {
  const auto waist = [&](const std::string& element) { return squat().at("SR1/WAIST/" + element, time); };
  Isometry3d root = Isometry3d::Identity();
  root.translation() = Vector3d(waist("position/x"), waist("position/y"), waist("position/z"));
  root.linear() =
      Eigen::Quaterniond(waist("orientation/w"), waist("orientation/x"), waist("orientation/y"), waist("orientation/z"))
          .normalized()
          .toRotationMatrix();
  std::vector<double> q;
  for (const int link : sr1().joints) q.push_back(squat().at("SR1/" + sr1().links[link].joint.name + "/q", time));
  return forward_kinematics(sr1(), root, q);
}

TEST(SR1Squat, SinksAndComesBack) {
  const double height = squat().at("SR1/WAIST/position/z", 0.2);
  EXPECT_NEAR(squat().at("SR1/WAIST/position/z", lowest), height - 0.15, 0.01);  // [m]
  EXPECT_NEAR(squat().last("SR1/WAIST/position/z"), height, 0.005);
  EXPECT_MATCHES_GOLDEN(squat());
}

TEST(SR1Squat, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("SR1Squat.SinksAndComesBack"); }

TEST(SR1Squat, KeepsItsFeetFlatAndWhereTheyAre) {
  for (const char* name : {"LLEG_ANKLE_R", "RLEG_ANKLE_R"}) {
    const int foot = sr1().find_link(name);
    const Vector3d place = links(0.2)[foot].translation();
    for (double time = 0.2; time < end; time += 0.1) {
      const Isometry3d now = links(time)[foot];
      const double tilt = std::acos(std::min(1.0, now.linear()(2, 2)));  // of the sole from the floor [rad]
      EXPECT_LT(tilt, 0.5 * degree) << name << " at " << time << " s";
      EXPECT_LT((now.translation() - place).norm(), 0.005) << name << " at " << time << " s";  // [m]
    }
  }
}

TEST(SR1Squat, StandsOnItsAnklesWithTheWeightOfAllAboveThem) {
  double carried = sr1().mass();
  for (const char* foot : {"LLEG_ANKLE_R", "RLEG_ANKLE_R"}) carried -= sr1().links[sr1().find_link(foot)].inertial.mass;
  const double measured = squat().mean("SR1/LeftAnkleForceSensor/force/z", 0.3, end) +
                          squat().mean("SR1/RightAnkleForceSensor/force/z", 0.3, end);
  EXPECT_NEAR(measured, carried * gravity, 0.02 * carried * gravity);  // it begins and ends at rest
}

TEST(SR1Squat, KeepsItsWaistUpright) {
  for (double time = 0.0; time < end; time += 0.05)
    EXPECT_GT(links(time)[0].linear()(2, 2), std::cos(3.0 * degree)) << "at " << time << " s";
}

TEST(SR1Squat, FollowsItsMotionOnlyWhileItsFeetCarryIt) {
  rehearse::BenchOptions options;
  options.options = "motion/sr1_squat.seq";
  options.time_step = 0.05;                  // [s]
  options.joints = {{"RLEG_KNEE", 0.0785}};  // as in the first frame [rad]
  rehearse::ControllerBench bench("SR1SquatController", "models/sr1.urdf", options);
  const auto press = [&](double force) {  // of the floor on each foot [N]
    bench.device("LeftAnkleForceSensor").values = {0.0, 0.0, force, 0.0, 0.0, 0.0};
    bench.device("RightAnkleForceSensor").values = bench.device("LeftAnkleForceSensor").values;
  };
  press(100.0);
  for (int i = 0; i < 20; ++i) bench.tick();
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, 0.0, 1e-9);  // [N·m]
  press(600.0);
  for (int i = 0; i < 21; ++i) bench.tick();  // the last one is a second after the first
  const double q = 1.2517;                    // of the frame at 1 s [rad]
  const double dq = (1.3879 - 0.927) / 0.4;   // between those before and after it [rad/s]
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, 8000.0 * (q - 0.0785) + 60.0 * dq, 1e-6);
}

TEST(SR1Squat, RefusesAMotionThatIsNotThere) {
  rehearse::BenchOptions options;
  options.options = "motion/sr1_flies.seq";
  EXPECT_THROW(rehearse::ControllerBench("SR1SquatController", "models/sr1.urdf", options), std::runtime_error);
}

}  // namespace
