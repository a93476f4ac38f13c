// The direct solver: the same step as ODE's exact solver, and robots that stand still as on paper.

#include <rehearse/urdf.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;
using Method = SolverSettings::Method;

std::shared_ptr<const Model> fixture(const std::string& name) {
  auto loaded = load_urdf(std::filesystem::path(FIXTURES_DIR) / "models" / (name + ".urdf"));
  if (!loaded) ADD_FAILURE() << to_string(loaded.errors());
  return std::make_shared<const Model>(std::move(*loaded));
}

/// The body at rest in a random posture, 10 m above the ground.
WorldBody posed(std::shared_ptr<const Model> model, std::mt19937& random) {
  const auto number = [&](double from, double to) {
    return from + (to - from) * (static_cast<double>(random()) / 4294967295.0);
  };
  WorldBody body = body_of(std::move(model), {0.0, 0.0, 10.0});
  for (std::size_t id = 0; id < body.joints.size(); ++id) {
    const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
    body.joints[id] = number(std::max(joint.lower, -1.0), std::min(joint.upper, 1.0));
  }
  return body;
}

class FixtureRobots : public ::testing::TestWithParam<const char*> {};

/// A step of both solvers from the same state at rest, in every mode of the joints. In motion they differ: ODE leaves
/// out that the equations of the joints turn with the bodies.
TEST_P(FixtureRobots, MoveAsUnderTheExactSolver) {
  const auto model = fixture(GetParam());
  std::mt19937 random(1);
  for (int trial = 0; trial < 12; ++trial) {
    const WorldBody body = posed(model, random);
    const auto world_of = [&](Method method) {
      WorldSettings settings = settings_of(method);
      settings.solver.cfm = 1e-14;  // the joints of ODE yield, those of the direct solver don't
      return make_world(settings, {body});
    };
    const auto exact = world_of(Method::exact), direct = world_of(Method::direct);
    Command command = idle(*exact);
    for (std::size_t id = 0; id < command.bodies[0].joints.size(); ++id) {
      JointCommand& joint = command.bodies[0].joints[id];
      const double share = static_cast<double>(random()) / 4294967295.0;
      switch (trial % 3) {
        case 0: joint = effort(20.0 * share - 10.0); break;
        case 1: joint = displacement(body.joints[id] + 0.16 * (share - 0.5)); break;  // farther ones are placed
        default: joint = velocity(2.0 * share - 1.0);
      }
    }
    for (World* world : {exact.get(), direct.get()}) {
      world->actuate(command);
      ASSERT_TRUE(world->step());
    }
    double speed = 1.0;
    for (const LinkReading& link : exact->sense().bodies[0].links)
      speed = std::max({speed, link.velocity.norm(), link.angular_velocity.norm()});
    for (std::size_t i = 0; i < model->links.size(); ++i) {
      const LinkReading &a = exact->sense().bodies[0].links[i], &b = direct->sense().bodies[0].links[i];
      EXPECT_LT((a.velocity - b.velocity).norm(), 1e-9 * speed) << model->links[i].name;
      EXPECT_LT((a.angular_velocity - b.angular_velocity).norm(), 1e-9 * speed) << model->links[i].name;
      EXPECT_LT((a.position - b.position).norm(), 1e-11 * speed) << model->links[i].name;
    }
    for (std::size_t id = 0; id < model->joints.size(); ++id) {
      const JointReading &a = exact->sense().bodies[0].joints[id], &b = direct->sense().bodies[0].joints[id];
      EXPECT_NEAR(a.u, b.u, 1e-6 * (1.0 + std::abs(a.u))) << "joint " << id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, FixtureRobots,
                         ::testing::Values("inverted_pendulum", "pan_tilt_head", "pendulum", "quadruped", "rover",
                                           "scout", "six_joint_arm", "spring_mass", "sr1", "tank", "tray_arm"),
                         [](const auto& name) { return std::string(name.param); });

/// A load of 2 kg half a metre off a hinge, held at rest by its drive.
TEST(TheDirectSolver, HoldsALoadWithTheTorqueOfItsWeight) {
  RobotBuilder robot(JointType::fixed);
  robot.add("ARM", 0, JointType::revolute, Vector3d::UnitY(), inertial(2.0, Vector3d::Constant(0.01), {0.5, 0.0, 0.0}));
  const auto world = make_world(settings_of(Method::direct), {body_of(robot.build())});
  run(*world, 100, displacement(0.0));  // until the joint's softness, ODE's CFM, has given way
  for (int i = 0; i < 100; ++i) {
    run(*world, 1, displacement(0.0));
    EXPECT_NEAR(joint_of(*world).u, -2.0 * standard_gravity * 0.5, 1e-8);
    EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-11);
  }
}

/// A body of 40 kg on an ankle of two joints with a cross link of 60 g between them.
std::shared_ptr<const Model> light_ankle() {
  RobotBuilder robot(JointType::fixed);
  robot.add("CROSS", 0, JointType::revolute, Vector3d::UnitY(), inertial(0.06, Vector3d::Constant(1e-5)));
  robot.add("BODY", 1, JointType::revolute, Vector3d::UnitX(), inertial(40.0, {4.0, 4.0, 1.0}, {0.02, 0.0, 0.9}));
  return robot.build();
}

/// A waist whose three axes cross, with light links between a pelvis and a heavy trunk.
std::shared_ptr<const Model> crossed_waist() {
  RobotBuilder robot(JointType::fixed);
  robot.add("YAW", 0, JointType::revolute, Vector3d::UnitZ(), inertial(0.1, Vector3d::Constant(2e-5)));
  robot.add("ROLL", 1, JointType::revolute, Vector3d::UnitX(), inertial(0.05, Vector3d::Constant(1e-5)));
  robot.add("TRUNK", 2, JointType::revolute, Vector3d::UnitY(), inertial(25.0, {1.5, 1.5, 0.5}, {0.05, 0.0, 0.3}));
  return robot.build();
}

/// A hand of 0.5 kg with three fingers of three links of 2 to 5 g; the outer joints of a finger follow its first.
std::shared_ptr<const Model> mimic_hand() {
  RobotBuilder robot(JointType::fixed);
  robot.add("PALM", 0, JointType::revolute, Vector3d::UnitX(), inertial(0.5, Vector3d::Constant(4e-4)));
  int link = 1, id = 1;
  for (int finger = 0; finger < 3; ++finger) {
    const int leader = id;
    for (int part = 0; part < 3; ++part, ++id) {
      const double mass = 0.005 - 0.0015 * part;
      const Eigen::Isometry3d origin = part == 0 ? at(0.02 * finger, 0.0, 0.05) : at(0.0, 0.0, 0.03);
      Joint& joint =
          robot.add("F" + std::to_string(finger) + std::to_string(part), part == 0 ? 1 : link, JointType::revolute,
                    Vector3d::UnitY(), inertial(mass, Vector3d::Constant(mass * 1e-4), {0.0, 0.0, 0.015}), origin);
      if (part > 0) joint.mimic = Mimic{leader, 0.8, 0.0};
      ++link;
    }
  }
  return robot.build();
}

class HeldRobots : public ::testing::TestWithParam<std::shared_ptr<const Model> (*)()> {};

TEST_P(HeldRobots, StandStill) {
  const auto world = make_world(settings_of(Method::direct), {body_of(GetParam()())});
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[0].joints) joint = displacement(0.0);
  world->actuate(command);
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(world->step());
    if (tick < 100) continue;
    for (const JointReading& joint : world->sense().bodies[0].joints) {
      EXPECT_LT(std::abs(joint.dq), 1e-7) << "tick " << tick;
      EXPECT_LT(std::abs(joint.q), 1e-9) << "tick " << tick;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Light, HeldRobots, ::testing::Values(light_ankle, crossed_waist, loaded_arm, mimic_hand));

/// The energy of a double pendulum that swings freely for 2 s from the horizontal swings no further than with the exact
/// solver.
TEST(TheDirectSolver, KeepsTheEnergyOfADoublePendulumAsTheExactSolver) {
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 2; ++i)
    robot.add("LINK" + std::to_string(i), i, JointType::revolute, Vector3d::UnitY(),
              inertial(1.0, Vector3d::Constant(0.01), {0.25, 0.0, 0.0}), at(i == 0 ? 0.0 : 0.5, 0.0, 0.0));
  const auto model = robot.build();
  const auto swing = [&](Method method) {
    const auto world = make_world(settings_of(method), {body_of(model)});
    double least = 0.0, most = 0.0;  // [J], from the beginning
    for (int tick = 0; tick < 2000; ++tick) {
      let_go(*world, 1);
      double energy = 0.0;
      for (int link = 1; link < 3; ++link) {
        const LinkReading& seen = link_of(*world, link);
        const Vector3d arm = seen.rotation * Vector3d(0.25, 0.0, 0.0);
        const Vector3d velocity = seen.velocity + seen.angular_velocity.cross(arm);
        energy += 0.5 * velocity.squaredNorm() + 0.005 * seen.angular_velocity.squaredNorm() +
                  standard_gravity * (seen.position + arm).z();
      }
      least = std::min(least, energy);
      most = std::max(most, energy);
    }
    return most - least;
  };
  const double exact = swing(Method::exact), direct = swing(Method::direct);
  EXPECT_LT(direct, 1.01 * exact + 1e-6);
}

/// Six joints without limits are commanded to 0.01 rad at once, 10 rad/s for a step: they are there after it, except
/// for the error of ODE's rotation by a velocity.
TEST(TheDirectSolver, ReachesDisplacementsInOneStep) {
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 6; ++i)
    robot.add("LINK" + std::to_string(i), i, JointType::revolute, i % 2 ? Vector3d::UnitZ() : Vector3d::UnitY(),
              inertial(1.0, Vector3d::Constant(0.01), {0.1, 0.0, 0.0}), at(i == 0 ? 0.0 : 0.2, 0.0, 0.0));
  const auto world = make_world(settings_of(Method::direct), {body_of(robot.build())});
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[0].joints) joint = displacement(0.01);
  world->actuate(command);
  ASSERT_TRUE(world->step());
  for (const JointReading& joint : world->sense().bodies[0].joints) EXPECT_NEAR(joint.q, 0.01, 1e-5);
}

/// SR1 dropped onto the floor from a millimetre and held: the feet carry its weight.
TEST(TheDirectSolver, LetsSr1StandOnItsWeight) {
  const auto model = fixture("sr1");
  WorldBody body = body_of(model, {0.0, 0.0, 0.7145});
  const auto world = make_world(settings_of(Method::direct), {floor_body(), body});
  std::vector<int> feet;
  for (std::size_t i = 0; i < model->links.size(); ++i) {
    if (model->links[i].collisions.empty()) continue;
    world->watch(1, static_cast<int>(i));
    feet.push_back(static_cast<int>(i));
  }
  Command command = idle(*world);
  for (JointCommand& joint : command.bodies[1].joints) joint = displacement(0.0);
  world->actuate(command);
  double mean = 0.0, squares = 0.0;
  constexpr int settling = 1000, measured = 1000;
  for (int tick = 0; tick < settling + measured; ++tick) {
    ASSERT_TRUE(world->step());
    if (tick < settling) continue;
    double force = 0.0;
    for (const int foot : feet)
      for (const ContactReading& contact : world->sense().bodies[1].contacts[static_cast<std::size_t>(foot)])
        force += contact.force.z();
    mean += force / measured;
    squares += force * force / measured;
  }
  const double weight = model->mass() * standard_gravity;
  EXPECT_NEAR(mean, weight, 1e-3 * weight);
  EXPECT_LT(std::sqrt(std::max(0.0, squares - mean * mean)), 0.1);  // [N]
  EXPECT_GT(link_of(*world, 0, 1).position.z(), 0.7);
}

/// SR1 on its feet under the torques of a stiff law: contacts that stick have one solution. Contacts of the direct
/// solver yield twenty times as much as joints.
TEST(TheDirectSolver, LetsSr1StandAsUnderTheExactSolver) {
  const auto model = fixture("sr1");
  const auto stand = [&](Method method, double cfm) {
    WorldSettings settings = settings_of(method);
    settings.solver.cfm = cfm;
    const auto world = make_world(settings, {floor_body(), body_of(model, {0.0, 0.0, 0.7135})});
    for (int tick = 0; tick < 400; ++tick) {
      Command command = idle(*world);
      const std::vector<JointReading>& joints = world->sense().bodies[1].joints;
      for (std::size_t id = 0; id < joints.size(); ++id)
        command.bodies[1].joints[id] = effort(-5000.0 * joints[id].q - 100.0 * joints[id].dq);
      world->actuate(command);
      EXPECT_TRUE(world->step());
    }
    return world->sense().bodies[1];
  };
  const auto compare = [](const BodyObservation& direct, const BodyObservation& exact, double tolerance) {
    for (std::size_t id = 0; id < exact.joints.size(); ++id)
      EXPECT_NEAR(direct.joints[id].q, exact.joints[id].q, tolerance) << "joint " << id;
    expect_near(direct.links[0].position, exact.links[0].position, tolerance);
  };
  // with equal softness of contacts, and so little of joints that a difference doesn't show
  compare(stand(Method::direct, 5e-14), stand(Method::exact, 1e-12), 1e-9);
  const double usual = SolverSettings().cfm;
  compare(stand(Method::direct, usual), stand(Method::exact, usual), 2e-8);
}

/// A robot that a box hits is solved with the box.
TEST(TheDirectSolver, SolvesABoxThatTouchesARobotWithTheRobot) {
  RobotBuilder robot(JointType::fixed);
  robot.add("TRAY", 0, JointType::revolute, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(0.01)));
  robot.add_collision(1, Box{{0.6, 0.4, 0.02}});
  const WorldBody box = free_box("Box", Vector3d::Constant(0.1), 2.0, {0.1, 0.0, 1.0602});
  const auto world = make_world(settings_of(Method::direct), {body_of(robot.build(), {0.0, 0.0, 1.0}), box});
  world->watch(1, 0);
  run(*world, 500, displacement(0.0));
  double force = 0.0;
  for (const ContactReading& contact : world->sense().bodies[1].contacts[0]) force += contact.force.z();
  EXPECT_NEAR(force, 2.0 * standard_gravity, 1e-4);
  EXPECT_NEAR(joint_of(*world).u, -2.0 * standard_gravity * 0.1, 1e-3);
}

/// A tray on a joint that carries 30 boxes at four points each.
TEST(TheDirectSolver, LeavesCrowdedIslandsToOde) {
  RobotBuilder robot(JointType::fixed);
  robot.add("TRAY", 0, JointType::revolute, Vector3d::UnitY(), inertial(5.0, Vector3d::Constant(1.0)));
  robot.add_collision(1, Box{{3.0, 3.0, 0.02}});
  std::vector<WorldBody> bodies{body_of(robot.build(), {0.0, 0.0, 1.0})};
  for (int i = 0; i < 30; ++i)
    bodies.push_back(free_box("Box" + std::to_string(i), Vector3d::Constant(0.1), 0.1,
                              {0.3 * (i % 6) - 0.75, 0.3 * (i / 6) - 0.6, 1.0599}));
  const auto world = make_world(settings_of(Method::direct), bodies);
  run(*world, 5, displacement(0.0));
  EXPECT_EQ(world->unsolved().contacts, 120);
  EXPECT_EQ(world->unsolved().most_contacts, 100);
  EXPECT_NEAR(joint_of(*world).q, 0.0, 0.01);
}

}  // namespace
}  // namespace rehearse
