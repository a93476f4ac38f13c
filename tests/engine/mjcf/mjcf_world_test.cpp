// MuJoCo's models in motion: a body with several joints against mechanics on paper, and the quadruped of a MuJoCo model
// beside that of the URDF.
#include <rehearse/body.h>

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>

#include "engine/world/robots.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const Model> loaded(const std::string& file) {
  auto model = load_model(file);
  if (model) return std::make_shared<const Model>(*std::move(model));
  ADD_FAILURE() << to_string(model.errors());
  return nullptr;
}

/// The joints of many planar robots: two slides and a hinge, which together constrain nothing in their plane.
TEST(MjcfWorld, ABodyOnTwoSlidesAndAHingeMovesFreelyInItsPlane) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() / "planar.xml";
  std::ofstream(file) << R"(<mujoco><worldbody><body name="plate" pos="0 0 2">
    <joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
    <joint name="turn" axis="0 1 0"/><geom type="box" size="0.3 0.1 0.2" pos="0.1 0 0.05" mass="3"/>
    </body></worldbody></mujoco>)";
  WorldBody body = body_of(loaded(file));
  const double spin = 4.0;  // [rad/s]
  body.joint_velocities = {0.5, 1.0, spin};
  const auto world = make_world(settings_of(SolverSettings::Method::direct), {body});
  const Vector3d arm(0.1, 0.0, 0.05);
  const auto center = [&] {
    const LinkReading& plate = link_of(*world, 3);
    return Vector3d(plate.position + plate.rotation * arm);
  };
  const Vector3d start = center();
  const Vector3d velocity = Vector3d(0.5, 0.0, 1.0) + Vector3d(0.0, spin, 0.0).cross(arm);
  constexpr double duration = 0.5;  // [s]
  let_go(*world, 500);
  const Vector3d fall(0.0, 0.0, -0.5 * standard_gravity * duration * duration);
  EXPECT_NEAR((center() - start - velocity * duration - fall).norm(), 0.0, 0.004);
  EXPECT_NEAR(joint_of(*world, 2).q, spin * duration, 0.002) << "nothing turns it";
}

/// The joints of the legs follow sines, diagonal legs together, as in a trot.
TEST(MjcfWorld, TheQuadrupedMovesAsThatOfTheUrdf) {
  std::vector<std::unique_ptr<World>> worlds;
  for (const char* file : {FIXTURES_DIR "/models/quadruped.urdf", FIXTURES_DIR "/models/quadruped.xml"}) {
    WorldBody robot = body_of(loaded(file), {0.0, 0.0, 0.3});
    ASSERT_EQ(robot.joints.size(), 12u);
    for (std::size_t leg = 0; leg < 4; ++leg) robot.joints[3 * leg + 1] = 0.8, robot.joints[3 * leg + 2] = -1.6;
    worlds.push_back(make_world(settings_of(SolverSettings::Method::direct), {robot, floor_body()}));
    ASSERT_TRUE(worlds.back());
  }
  double lowest = 1.0;
  for (int tick = 0; tick < 2000; ++tick) {
    for (const auto& world : worlds) {
      Command command = idle(*world);
      for (std::size_t joint = 0; joint < 12; ++joint) {
        const std::size_t leg = joint / 3, part = joint % 3;
        const double phase = 2.0 * pi * 2.5 * 0.001 * tick + (leg == 0 || leg == 3 ? 0.0 : pi);
        const double swing = 0.06 * std::sin(phase) * std::min(1.0, 0.002 * tick);
        command.bodies[0].joints[joint] = displacement(part == 0 ? 0.0 : part == 1 ? 0.8 + swing : -1.6 - swing);
      }
      world->actuate(command);
      ASSERT_TRUE(world->step());
    }
    for (int link = 0; link < 17; ++link) {
      const LinkReading &of_urdf = link_of(*worlds[0], link), &of_mujoco = link_of(*worlds[1], link);
      ASSERT_NEAR((of_urdf.position - of_mujoco.position).norm(), 0.0, 1e-9) << link << " at tick " << tick;
      ASSERT_NEAR((of_urdf.velocity - of_mujoco.velocity).norm(), 0.0, 1e-9) << link << " at tick " << tick;
    }
    for (int joint = 0; joint < 12; ++joint)
      ASSERT_NEAR(joint_of(*worlds[0], joint).q, joint_of(*worlds[1], joint).q, 1e-9) << joint << " at tick " << tick;
    lowest = std::min(lowest, link_of(*worlds[0]).position.z());
  }
  EXPECT_GT(lowest, 0.25) << "it stays on its feet";
  EXPECT_LT(link_of(*worlds[0]).position.z(), 0.35) << "and on the floor";
}

}  // namespace
}  // namespace rehearse
