// Tracks: links whose surface runs about an axis (Choreonoid's pseudo continuous tracks).

#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

JointCommand run_belt(double speed) { return velocity(speed); }

class Tracks : public EachSolver {
 protected:
  WorldSettings settings() const {
    WorldSettings settings = settings_of(GetParam());
    settings.solver.iterations = 200;
    return settings;
  }

  /// A chassis of 10 kg on two tracks along x, 0.6 m apart, on the ground.
  static WorldBody vehicle(double length = 0.4) {
    RobotBuilder robot(JointType::free, inertial(8.0, {0.3, 0.4, 0.5}));
    robot.add("LEFT", 0, JointType::track, Vector3d::UnitY(), inertial(1.0, {0.01, 0.03, 0.03}), at(0, 0.3, 0));
    robot.add("RIGHT", 0, JointType::track, Vector3d::UnitY(), inertial(1.0, {0.01, 0.03, 0.03}), at(0, -0.3, 0));
    for (const int link : {1, 2}) robot.add_collision(link, Box{{length, 0.1, 0.2}});
    return body_of(robot.build(), {0, 0, 0.1});
  }

  static void drive(World& world, int ticks, double left, double right) {
    Command command = idle(world);
    command.bodies[0].joints = {run_belt(left), run_belt(right)};
    for (int i = 0; i < ticks; ++i) {
      world.actuate(command);
      ASSERT_TRUE(world.step());
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Tracks, each_solver, solver_name);

TEST_P(Tracks, CarryAVehicleForwardsAsWheelsWould) {
  const auto world = make_world(settings(), {vehicle(), floor_body()});
  drive(*world, 1000, 0.5, 0.5);
  EXPECT_NEAR(link_of(*world).velocity.x(), 0.5, 0.01);
  EXPECT_NEAR(link_of(*world).position.y(), 0.0, 0.01);
  const double x = link_of(*world).position.x();
  drive(*world, 1000, 0.5, 0.5);
  EXPECT_NEAR(link_of(*world).position.x() - x, 0.5, 0.01);
}

TEST_P(Tracks, DriveTheSameWhicheverBodyComesFirst) {
  const auto world = make_world(settings(), {floor_body(), vehicle()});
  Command command = idle(*world);
  command.bodies[1].joints = {run_belt(0.5), run_belt(0.5)};
  for (int i = 0; i < 1000; ++i) {
    world->actuate(command);
    ASSERT_TRUE(world->step());
  }
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.x(), 0.5, 0.01);
}

TEST_P(Tracks, TurnAVehicleOnTheSpotByOppositeSpeeds) {
  const auto world = make_world(settings(), {vehicle(), floor_body()});
  drive(*world, 1500, -0.3, 0.3);
  EXPECT_GT(link_of(*world).angular_velocity.z(), 0.2);  // to the left; 1 rad/s less what slips sideways
  EXPECT_LT(link_of(*world).position.head<2>().norm(), 0.05);
}

TEST_P(Tracks, SlipSidewaysMoreEasilyThanTheyPull) {
  // Lengthwise mu is 1, sideways 0.5: tracks turn a vehicle up to a length of twice their distance.
  const auto turn = [&](double length) {
    const auto world = make_world(settings(), {vehicle(length), floor_body()});
    drive(*world, 1500, -0.3, 0.3);
    return link_of(*world).angular_velocity.z();
  };
  EXPECT_GT(turn(1.0), 0.2);
  EXPECT_LT(turn(1.4), 0.01);
}

/// The vehicle comes up from a millimetre, and rests in the surface layer, 0.1 mm deep.
TEST_P(Tracks, DontDriveContactsBeyondTheirDepth) {
  WorldSettings shallow = settings();
  shallow.solver.belt_depth = 5e-5;
  WorldBody deep = vehicle();
  deep.position.z() = 0.099;
  const auto world = make_world(shallow, {deep, floor_body()});
  drive(*world, 1000, 0.5, 0.5);
  EXPECT_NEAR(link_of(*world).velocity.x(), 0.0, 0.01);
}

TEST_P(Tracks, HoldStillWithoutACommand) {
  const auto world = make_world(settings(), {vehicle(), floor_body()});
  drive(*world, 500, 0.5, 0.5);
  let_go(*world, 500);
  EXPECT_NEAR(link_of(*world).velocity.norm(), 0.0, 0.01);
}

TEST_P(Tracks, TellTheirSpeedAndHaveNoDisplacement) {
  const auto world = make_world(settings(), {vehicle(), floor_body()});
  drive(*world, 10, 0.25, -0.5);
  EXPECT_EQ(joint_of(*world, 0).dq, 0.25);
  EXPECT_EQ(joint_of(*world, 1).dq, -0.5);
  EXPECT_EQ(joint_of(*world, 0).q, 0.0);
}

TEST_P(Tracks, OfAFixedBodyAreAConveyor) {
  RobotBuilder robot(JointType::fixed);
  robot.add("BELT", 0, JointType::track, Vector3d::UnitY(), {}, at(0, 0, -0.1));
  robot.add_collision(1, Box{{4.0, 1.0, 0.2}});
  const auto world =
      make_world(settings(), {body_of(robot.build()), free_box("Parcel", {0.2, 0.2, 0.2}, 2.0, {0, 0, 0.1})});
  Command command = idle(*world);
  command.bodies[0].joints[0] = run_belt(0.4);
  for (int i = 0; i < 1000; ++i) {
    world->actuate(command);
    ASSERT_TRUE(world->step());
  }
  // the top of a wheel that rolls forwards goes forwards
  EXPECT_NEAR(link_of(*world, 0, 1).velocity.x(), 0.4, 0.01);
}

TEST_P(Tracks, GoOnTheSameFromARestoredState) {
  const auto world = make_world(settings(), {vehicle(), floor_body()});
  drive(*world, 100, 0.5, 0.4);
  const auto state = world->save();
  drive(*world, 100, 0.5, 0.4);
  const std::uint64_t end = world->state_hash();
  const auto fresh = make_world(settings(), {vehicle(), floor_body()});
  ASSERT_TRUE(fresh->restore(state).ok());
  drive(*fresh, 100, 0.5, 0.4);
  EXPECT_EQ(fresh->state_hash(), end);
}

}  // namespace
}  // namespace rehearse
