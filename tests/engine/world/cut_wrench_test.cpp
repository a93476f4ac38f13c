// Force sensors on links behind fixed joints: the wrench of the links behind the joint on those before it.

#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double mass = 3.0;                        // of the links behind the cut [kg]
constexpr double weight = mass * standard_gravity;  // [N]

class CutWrenches : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, CutWrenches, each_solver, solver_name);

/// Adds the link HAND behind a fixed joint, and a force sensor in it.
int add_hand(RobotBuilder& robot, int parent, const Inertial& hand, const Eigen::Isometry3d& origin,
             const Eigen::Isometry3d& sensor = Eigen::Isometry3d::Identity()) {
  const int link = static_cast<int>(robot.build()->links.size());
  robot.add("HAND", parent, JointType::fixed, Vector3d::UnitX(), hand, origin);
  robot.add_device("Sensor", link, ForceSensor{}, sensor);
  return link;
}

TEST_P(CutWrenches, AHangingMassPullsAtTheWorldWithItsWeight) {
  RobotBuilder robot(JointType::fixed, inertial(100.0, {1, 1, 1}));
  add_hand(robot, 0, inertial(mass, {0.1, 0.2, 0.3}, {0.1, 0.05, -0.2}), at(0.3, 0, 1));
  const auto world = make_world(settings(), {body_of(robot.build(), {5, 6, 7})});
  run(*world, 1);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -weight), 1e-9);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0.1, 0.05, -0.2).cross(Vector3d(0, 0, -weight)), 1e-9);
}

TEST_P(CutWrenches, AreReadInTheSensorsFrameAboutItsOrigin) {
  RobotBuilder robot(JointType::fixed);
  Eigen::Isometry3d sensor = at(0.2, 0, 0);
  sensor.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix();  // its y axis is the link's z
  add_hand(robot, 0, inertial(mass, {0.1, 0.1, 0.1}, {0.5, 0, 0}), at(0, 0, 0), sensor);
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 1);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, -weight, 0), 1e-9);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, 0, -0.3 * weight), 1e-9);
}

TEST_P(CutWrenches, LinksBehindTheSensorsOwnCountAndThoseBesideItDoNot) {
  RobotBuilder robot(JointType::fixed);
  const int hand = add_hand(robot, 0, inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, 0));
  robot.add("FINGER", hand, JointType::fixed, Vector3d::UnitX(), inertial(0.5, {0.1, 0.1, 0.1}), at(0.2, 0, 0));
  robot.add("OTHER", 0, JointType::fixed, Vector3d::UnitX(), inertial(7.0, {0.1, 0.1, 0.1}), at(0, 1, 0));
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 1);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -1.5 * standard_gravity), 1e-9);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, 0.2 * 0.5 * standard_gravity, 0), 1e-9);
}

TEST_P(CutWrenches, ALinkWithoutWeightHasOnlyItsInertia) {
  RobotBuilder robot(JointType::fixed);
  add_hand(robot, 0, inertial(mass, {0.1, 0.1, 0.1}, {0.1, 0, 0}), at(0, 0, 0));
  auto model = std::make_shared<Model>(*robot.build());
  model->links[1].has_weight = false;
  const auto world = make_world(settings(), {body_of(model)});
  run(*world, 1);
  expect_near(device_of(*world, 0), Eigen::VectorXd::Zero(6).eval(), 1e-12);
}

TEST_P(CutWrenches, AMassThatIsLiftedPushesBackWithItsInertia) {
  RobotBuilder robot(JointType::fixed);
  robot.add("SLED", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(2.0, {0.1, 0.1, 0.1}));
  add_hand(robot, 1, inertial(mass, {0.1, 0.1, 0.1}, {0, 0.1, 0}), at(0.4, 0, 0));
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 10, effort(80.0));
  const double lifted = 80.0 / 5.0 * mass;  // its share of the effort
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -lifted), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(-0.1 * lifted, 0, 0), 1e-2);
}

TEST_P(CutWrenches, AMassOnATurningArmPullsOutwards) {
  constexpr double radius = 0.5, rate = 5.0;
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.1}, {0.2, 0, 0}));
  Inertial hand = inertial(mass, {0.3, 0.3, 0.3}, {0.1, 0, 0});
  hand.inertia(0, 2) = hand.inertia(2, 0) = 0.05;
  add_hand(robot, 1, hand, at(radius - 0.1, 0, 0));
  WorldSettings fine = weightless(GetParam());
  fine.time_step = 1e-4;
  const auto world = make_world(fine, {body_of(robot.build())});
  run(*world, 3000, velocity(rate));
  ASSERT_NEAR(joint_of(*world).dq, rate, 1e-6);
  const double pull = mass * radius * rate * rate;
  expect_near(device_of(*world, 0).head<3>(), Vector3d(pull, 0, 0), 0.002 * pull);
  // the hand needs w x (I w) = (0, Ixz w², 0), and the reading is the opposite
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, -0.05 * rate * rate, 0), 0.01);
}

TEST_P(CutWrenches, AnArmThatIsSpunUpIsHeldBack) {
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.2}));
  add_hand(robot, 1, inertial(mass, {0.1, 0.1, 0.3}), at(0.5, 0, 0));
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  run(*world, 1, effort(2.0));
  const double turn = 2.0 / (0.2 + 0.3 + mass * 0.25);  // [rad/s²]
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, -mass * 0.5 * turn, 0), 1e-6);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, 0, -0.3 * turn), 1e-6);
}

TEST_P(CutWrenches, AFootCarriesWhatStandsOnIt) {
  RobotBuilder robot(JointType::free, inertial(10.0, {0.2, 0.2, 0.2}));
  const int foot = add_hand(robot, 0, inertial(2.0, {0.02, 0.02, 0.02}), at(0, 0, -0.5));
  robot.add_collision(foot, Box{{0.3, 0.3, 0.1}});
  const auto world = make_world(settings(), {body_of(robot.build(), {0, 0, 0.55}), floor_body()});
  run(*world, 1000);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
  for (int i = 0; i < 1000; ++i) {
    run(*world, 1);
    mean += device_of(*world, 0) / 1000;
  }
  expect_near(mean, (Eigen::VectorXd(6) << 0, 0, 10.0 * standard_gravity, 0, 0, 0).finished(), 0.05);
}

TEST_P(CutWrenches, AFixedShelfFeelsWhatLiesOnIt) {
  RobotBuilder robot(JointType::fixed);
  const int shelf = add_hand(robot, 0, {}, at(0, 0, -0.1));
  robot.add_collision(shelf, Box{{1, 1, 0.2}});
  for (const bool shelf_first : {true, false}) {
    std::vector<WorldBody> bodies{body_of(robot.build()), free_box("Box", {0.2, 0.2, 0.2}, 2.0, {0.3, 0, 0.1})};
    if (!shelf_first) std::swap(bodies[0], bodies[1]);
    const auto world = make_world(settings(), bodies);
    run(*world, 1000);
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
    for (int i = 0; i < 200; ++i) {
      run(*world, 1);
      mean += device_of(*world, 0, shelf_first ? 0 : 1) / 200;
    }
    const double load = 2.0 * standard_gravity;
    expect_near(mean.head<3>(), Vector3d(0, 0, -load), 0.05);
    expect_near(mean.tail<3>(), Vector3d(0, 0.3 * load, 0), 0.05);
  }
}

TEST_P(CutWrenches, APushOnWhatIsBehindGoesThrough) {
  RobotBuilder robot(JointType::fixed);
  add_hand(robot, 0, inertial(mass, {0.1, 0.1, 0.1}), at(0.3, 0, 0));
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build(), {1, 0, 0})});
  world->push(0, 1, {0, 4, 0}, {0.25, 0, 0}, {0, 0, 0.5});
  world->push(0, 0, {9, 9, 9}, Vector3d::Zero(), Vector3d::Zero());  // before the cut: not felt
  run(*world, 1);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 4, 0), 1e-12);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, 0, 0.25 * 4 + 0.5), 1e-12);
  run(*world, 1);  // it lasted one step
  expect_near(device_of(*world, 0), Eigen::VectorXd::Zero(6).eval(), 1e-12);
}

TEST_P(CutWrenches, APushOnAFlyingBodyIsFeltByItsShare) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  add_hand(robot, 0, inertial(mass, {0.1, 0.1, 0.1}), at(0, 0, 0));
  const auto world = make_world(settings(), {body_of(robot.build())});
  Command command = idle(*world);
  command.bodies[0].external[1].force = {8, 0, 0};  // on the hand, whose 3 kg of 4 need 6 N of it
  world->actuate(command);
  run(*world, 1);
  expect_near(device_of(*world, 0).head<3>(), Vector3d(2, 0, 0), 1e-9);
  run(*world, 1);  // free fall: nothing is left
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, 0), 1e-9);
}

TEST_P(CutWrenches, InTheMiddleOfAChainTheyCarryTheArmBehind) {
  RobotBuilder robot(JointType::fixed);
  const int wrist = add_hand(robot, 0, inertial(1.0, {0.1, 0.1, 0.1}), at(0, 0, 1));
  robot.add("ARM", wrist, JointType::revolute, Vector3d::UnitY(), inertial(mass, {0.01, 0.05, 0.05}, {0.4, 0, 0}),
            at(0.2, 0, 0));
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 100, effort(-weight * 0.4));  // holds it level
  expect_near(device_of(*world, 0).head<3>(), Vector3d(0, 0, -weight - standard_gravity), 1e-2);
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, weight * 0.6, 0), 1e-2);
  run(*world, 100, displacement(0.0));  // a motor's force between the two is a force like any other
  expect_near(device_of(*world, 0).tail<3>(), Vector3d(0, weight * 0.6, 0), 2e-2);
}

TEST_P(CutWrenches, BeforeAMovingJointReadWhatASensorInTheJointDoes) {
  // A double pendulum with damping falls freely. The massless mount of its second arm has a sensor, that arm another.
  RobotBuilder robot(JointType::fixed);
  const Inertial arm = inertial(1.5, {0.01, 0.05, 0.05}, {0.3, 0.02, 0});
  robot.add("UPPER", 0, JointType::revolute, Vector3d::UnitY(), arm, at(0, 0, 1));
  const int mount = add_hand(robot, 1, {}, at(0.6, 0, 0));
  robot.add("LOWER", mount, JointType::revolute, Vector3d::UnitY(), arm).damping = 0.2;
  robot.add_device("InTheJoint", mount + 1, ForceSensor{});
  WorldSettings fine = settings();
  fine.time_step = 1e-4;
  const auto world = make_world(fine, {body_of(robot.build())});
  Command command = idle(*world);
  command.bodies[0].joints[1] = effort(0.7);
  for (int i = 0; i < 5000; ++i) {
    world->actuate(command);
    ASSERT_TRUE(world->step());
    if (i % 500 != 499) continue;
    const Matrix3d turn = Eigen::AngleAxisd(joint_of(*world, 1).q, Vector3d::UnitY()).toRotationMatrix();
    const Eigen::VectorXd joint = device_of(*world, 1), cut = device_of(*world, 0);
    expect_near(cut.head<3>(), (turn * joint.head<3>()).eval(), 0.002 * joint.head<3>().norm() + 0.01);
    expect_near(cut.tail<3>(), (turn * joint.tail<3>()).eval(), 0.02);
  }
  EXPECT_GT(std::abs(joint_of(*world, 0).dq) + std::abs(joint_of(*world, 1).dq), 1.0);  // it did swing
}

TEST_P(CutWrenches, BeforeASliderUnderEffortReadWhatASensorInTheSliderDoes) {
  RobotBuilder robot(JointType::free, inertial(4.0, {0.3, 0.3, 0.3}));
  const int mount = add_hand(robot, 0, {}, at(0.2, 0, 0.1));
  robot.add("SLED", mount, JointType::prismatic, Vector3d::UnitX(), inertial(2.0, {0.1, 0.1, 0.1}, {0, 0.3, 0}));
  robot.add_device("InTheJoint", mount + 1, ForceSensor{});
  const auto world = make_world(weightless(GetParam()), {body_of(robot.build())});
  run(*world, 1, effort(5.0));
  expect_near(device_of(*world, 0), Eigen::VectorXd(device_of(*world, 1)), 1e-4);
}

TEST_P(CutWrenches, AgreeWithAMovableJointThatAMotorLocks) {
  constexpr int sled = 0, wrist = 1;  // joint ids
  const auto robot = [](JointType wrist_type) {
    RobotBuilder made(JointType::fixed);
    made.add("SLED", 0, JointType::prismatic, Vector3d(1, 0, 0), inertial(2.0, {0.1, 0.1, 0.1}));
    made.add("HAND", 1, wrist_type, Vector3d::UnitZ(), inertial(mass, {0.1, 0.1, 0.1}, {0.1, 0.2, 0.05}),
             at(0.3, 0, 0));
    made.add_device("Sensor", 2, ForceSensor{});
    return body_of(made.build());
  };
  const auto fixed = make_world(settings(), {robot(JointType::fixed)});
  const auto locked = make_world(settings(), {robot(JointType::revolute)});
  Command command = idle(*locked);
  for (int i = 0; i < 200; ++i) {
    command.bodies[0].joints[sled] = effort(i < 100 ? 20.0 : -20.0);
    command.bodies[0].joints[wrist] = displacement(0.0);
    locked->actuate(command);
    ASSERT_TRUE(locked->step());
    run(*fixed, 1, command.bodies[0].joints[sled]);
    expect_near(device_of(*fixed, 0), Eigen::VectorXd(device_of(*locked, 0)), 0.005);
  }
  EXPECT_NEAR(device_of(*fixed, 0)[0], 20.0 * mass / 5.0, 1e-2);
}

TEST_P(CutWrenches, ATracksJointIsCutLikeAFixedOne) {
  RobotBuilder robot(JointType::fixed);
  robot.add("BELT", 0, JointType::track, Vector3d::UnitY(), {}, at(0, 0, -0.1));
  robot.add_collision(1, Box{{4.0, 1.0, 0.2}});
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto world =
      make_world(settings(), {body_of(robot.build()), free_box("Parcel", {0.2, 0.2, 0.2}, 2.0, {-1, 0, 0.1})});
  run(*world, 300, velocity(0.0));
  run(*world, 1, velocity(1.0));  // the track's friction accelerates the parcel; the reaction acts on the track
  EXPECT_LT(device_of(*world, 0)[0], -1.0);
  EXPECT_NEAR(device_of(*world, 0)[0], -2.0 * link_of(*world, 0, 1).acceleration.x(), 1e-3);
}

TEST_P(CutWrenches, ARestoredWorldReadsWhatTheSavedOneDid) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  const int foot = add_hand(robot, 0, inertial(2.0, {0.02, 0.02, 0.02}), at(0, 0, -0.5));
  robot.add_collision(foot, Box{{0.3, 0.3, 0.1}});
  const std::vector<WorldBody> bodies{body_of(robot.build(), {0, 0, 0.55}), floor_body()};
  const auto original = make_world(settings(), bodies), copy = make_world(settings(), bodies);
  run(*original, 20);
  ASSERT_TRUE(copy->restore(original->save()).ok());
  EXPECT_EQ(device_of(*copy, 0), device_of(*original, 0));
  EXPECT_GT(device_of(*copy, 0).norm(), 1.0);
  run(*original, 20);
  run(*copy, 20);
  EXPECT_EQ(device_of(*copy, 0), device_of(*original, 0));
  EXPECT_EQ(copy->state_hash(), original->state_hash());
}

TEST_P(CutWrenches, MeasuringChangesNothingInTheMotion) {
  RobotBuilder robot(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  robot.add("FOOT", 0, JointType::fixed, Vector3d::UnitX(), inertial(2.0, {0.02, 0.02, 0.02}), at(0, 0, -0.5));
  robot.add("ARM", 1, JointType::revolute, Vector3d::UnitY(), inertial(1.0, {0.1, 0.1, 0.1}, {0.2, 0, 0}));
  robot.add_collision(1, Box{{0.3, 0.3, 0.1}});
  const auto without = make_world(settings(), {body_of(robot.build(), {0, 0, 0.55}), floor_body()});
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto with = make_world(settings(), {body_of(robot.build(), {0, 0, 0.55}), floor_body()});
  let_go(*without, 500);
  let_go(*with, 500);
  EXPECT_EQ(link_of(*with, 2).position, link_of(*without, 2).position);
  EXPECT_EQ(joint_of(*with).q, joint_of(*without).q);
}

}  // namespace
}  // namespace rehearse
