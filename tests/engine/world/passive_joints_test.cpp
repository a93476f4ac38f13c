// What resists a joint's motion: damping and the inertia of the drive's rotor, compared with their formulas.

#include <cmath>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double step = 0.001;  // [s]

class PassiveJoints : public EachSolver {
 protected:
  WorldSettings settings() const {
    WorldSettings settings = weightless(GetParam());
    settings.solver.iterations = 100;  // with 50 the pendulum is off by 1.1 % after the first step
    return settings;
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, PassiveJoints, each_solver, solver_name);

/// A robot with one joint, and the inertia about or along it.
struct OneJoint {
  const char* name;
  std::shared_ptr<const Model> model;
  double inertia;
};

/// `describe` gets the joint and its inertia.
template <class Describe>
std::vector<OneJoint> one_joint_robots(Describe describe) {
  std::vector<OneJoint> robots;
  const auto add = [&](const char* name, RobotBuilder& robot, Joint& joint, double inertia) {
    describe(joint, inertia);
    robots.push_back({name, robot.build(), inertia});
  };
  RobotBuilder pendulum(JointType::fixed);  // its centre is far from the axis
  add("pendulum", pendulum,
      pendulum.add("ROD", 0, JointType::revolute, Vector3d::UnitY(), inertial(2.0, {0.01, 0.02, 0.01}, {0, 0, -0.3})),
      0.02 + 2.0 * 0.09);
  RobotBuilder slider(JointType::fixed);
  add("slider", slider, slider.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(3.0, {1, 1, 1})), 3.0);
  RobotBuilder pair(JointType::free, inertial(1.0, {0.1, 0.1, 0.3}));
  add("wheels", pair, pair.add("WHEEL", 0, JointType::continuous, Vector3d::UnitZ(), inertial(1.0, {0.1, 0.1, 0.2})),
      0.3 * 0.2 / 0.5);
  RobotBuilder free_slider(JointType::free, inertial(1.0, {0.1, 0.1, 0.1}));
  add("free slider", free_slider,
      free_slider.add("SLED", 0, JointType::prismatic, Vector3d::UnitX(), inertial(3.0, {1, 1, 1})), 0.75);
  return robots;
}

TEST_P(PassiveJoints, DampingSlowsASingleJointExponentially) {
  for (const double ratio : {0.01, 0.1, 1.0, 3.0, 10.0, 100.0})  // damping times time step over inertia
    for (const OneJoint& robot :
         one_joint_robots([&](Joint&joint, double inertia) { joint.damping = ratio * inertia / step; })) {
      SCOPED_TRACE(std::string(robot.name) + ", " + std::to_string(ratio));
      const auto world = make_world(settings(), {body_of(robot.model)});
      run(*world, 1, velocity(1.0));
      const double first = joint_of(*world).dq;
      EXPECT_NEAR(first, 1.0, 1e-3);
      for (int ticks = 1; ticks <= 50; ++ticks) {
        let_go(*world, 1);
        const double expected = first * std::exp(-ratio * ticks);
        ASSERT_NEAR(joint_of(*world).dq, expected, 0.01 * expected + 1e-6) << "after " << ticks << " ticks";
      }
      EXPECT_EQ(joint_of(*world).u, 0.0);  // damping is no effort of the actuator
    }
}

TEST_P(PassiveJoints, AnEffortOnADampedJointReachesItsSpeed) {
  for (const double ratio : {0.01, 1.0, 100.0})
    for (const OneJoint& robot :
         one_joint_robots([&](Joint&joint, double inertia) { joint.damping = ratio * inertia / step; })) {
      SCOPED_TRACE(std::string(robot.name) + ", " + std::to_string(ratio));
      const auto world = make_world(settings(), {body_of(robot.model)});
      run(*world, 800, effort(0.7 * ratio * robot.inertia / step));
      EXPECT_NEAR(joint_of(*world).dq, 0.7, 0.007);
    }
}

TEST_P(PassiveJoints, DampingWorksAgainstADriveAtItsLimit) {
  for (const OneJoint& robot : one_joint_robots([](Joint&joint, double inertia) {
         joint.damping = 100.0 * inertia;
         joint.effort = 40.0 * inertia;
       })) {
    SCOPED_TRACE(robot.name);
    const auto world = make_world(settings(), {body_of(robot.model)});
    run(*world, 300, velocity(1.0));
    EXPECT_NEAR(joint_of(*world).dq, 0.4, 0.004);
    EXPECT_NEAR(joint_of(*world).u, 40.0 * robot.inertia, 0.4 * robot.inertia);
    run(*world, 300, velocity(0.2));
    EXPECT_NEAR(joint_of(*world).dq, 0.2, 1e-4);
    EXPECT_NEAR(joint_of(*world).u, 20.0 * robot.inertia, 0.2 * robot.inertia);
  }
}

// On paper I dv/dt = -(limit + d v): damping helps a drive that brakes.
TEST_P(PassiveJoints, DampingHelpsADriveThatBrakesAtItsLimit) {
  for (const double ratio : {0.01, 0.1, 1.0}) {            // of the damping times the time step over inertia
    const double rate = ratio / step, limit = 0.5 * rate;  // [1/s], [rad/s²] or [m/s²]
    for (const OneJoint& robot : one_joint_robots([&](Joint&joint, double inertia) {
           joint.damping = rate * inertia;
           joint.effort = limit * inertia;
         })) {
      SCOPED_TRACE(std::string(robot.name) + ", " + std::to_string(ratio));
      WorldBody body = body_of(robot.model);
      body.joint_velocities = {1.0};
      const auto world = make_world(settings(), {body});
      for (int ticks = 1;; ++ticks) {
        const double expected = (1.0 + limit / rate) * std::exp(-ratio * ticks) - limit / rate;
        if (expected < 0.05) break;
        run(*world, 1, velocity(0.0));
        ASSERT_NEAR(joint_of(*world).dq, expected, 0.02) << "after " << ticks << " ticks";
      }
    }
  }
}

/// Four fingers of four light links on a palm, as hands have them.
std::shared_ptr<const Model> hand(double damping) {
  RobotBuilder robot(JointType::free, inertial(0.4, {5e-4, 4e-4, 3e-4}));
  for (int finger = 0; finger < 4; ++finger) {
    int parent = 0;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Isometry3d place = i == 0 ? at(0.0, 0.04 * finger - 0.06, 0.1) : at(0.0, 0.0, i == 1 ? 0.016 : 0.05);
      Joint& joint =
          robot.add("LINK" + std::to_string(4 * finger + i), parent, JointType::revolute,
                    i == 0 ? Vector3d::UnitZ() : Vector3d::UnitY(),
                    inertial(i == 0 ? 0.012 : 0.05, Vector3d::Constant(i == 0 ? 1e-6 : 1e-5), {0, 0, 0.02}), place);
      joint.damping = damping;
      joint.effort = 15.0;
      joint.velocity = 7.0;
      parent = 4 * finger + i + 1;
    }
  }
  return robot.build();
}

TEST(HeldHand, IsntShakenByItsDamping) {
  for (const double damping : {0.0, 0.03, 3.0}) {  // times the time step over inertia: up to 3000
    SCOPED_TRACE(damping);
    const auto world = make_world({}, {body_of(hand(damping))});  // it falls freely
    Command command = idle(*world);
    for (JointCommand& joint : command.bodies[0].joints) joint = displacement(0.0);
    for (int i = 0; i < 1000; ++i) {
      world->actuate(command);
      ASSERT_TRUE(world->step());
      for (int id = 0; id < 16; ++id) ASSERT_LT(std::abs(joint_of(*world, id).dq), 0.01) << "step " << i;
    }
  }
}

TEST_P(PassiveJoints, DampingActsBesideDryFriction) {
  for (const OneJoint& robot : one_joint_robots([](Joint&joint, double inertia) {
         joint.damping = 10.0 * inertia;
         joint.friction = 2.0 * inertia;
       })) {
    SCOPED_TRACE(robot.name);
    const auto world = make_world(settings(), {body_of(robot.model)});
    run(*world, 1, velocity(1.0));
    const double first = joint_of(*world).dq;
    let_go(*world, 100);
    EXPECT_NEAR(joint_of(*world).dq, (first + 0.2) * std::exp(-1.0) - 0.2, 0.005);
    let_go(*world, 200);
    EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-6);
  }
}

/// Kinetic energy of the first body [J].
double energy_of(const World& world, const Model& model) {
  double energy = 0.0;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Inertial& inertial = model.links[i].inertial;
    const LinkReading& link = link_of(world, static_cast<int>(i));
    const Eigen::Matrix3d axes = link.rotation.toRotationMatrix();
    const Vector3d velocity = link.velocity + link.angular_velocity.cross(axes * inertial.center);
    const Vector3d spin = axes.transpose() * link.angular_velocity;
    energy += 0.5 * inertial.mass * velocity.squaredNorm() + 0.5 * spin.dot(inertial.inertia * spin);
  }
  return energy;
}

TEST_P(PassiveJoints, DampingOfAChainNeverAddsEnergy) {
  for (const double damping : {0.001, 0.1, 1.0, 10.0, 1000.0}) {  // one link's inertia over the time step is 13
    SCOPED_TRACE(damping);
    RobotBuilder robot(JointType::fixed);
    for (int i = 0; i < 5; ++i) {
      const Vector3d axis = i % 2 ? Vector3d::UnitX() : Vector3d::UnitY();
      robot
          .add("LINK" + std::to_string(i), i, JointType::revolute, axis,
               inertial(1.0, {0.0033, 0.0033, 0.0002}, {0, 0, -0.1}), at(0, 0, i == 0 ? 0.0 : -0.2))
          .damping = damping;
    }
    const auto model = robot.build();
    WorldSettings exact = settings();
    exact.solver.iterations = 500;
    const auto world = make_world(exact, {body_of(model)});
    Command command = idle(*world);
    for (int id = 0; id < 5; ++id) command.bodies[0].joints[id] = velocity(id % 2 ? -1.0 : 2.0);
    world->actuate(command);
    ASSERT_TRUE(world->step());
    const double first = energy_of(*world, *model);
    let_go(*world, 1);
    double energy = energy_of(*world, *model);
    for (int i = 0; i < 500; ++i) {
      let_go(*world, 1);
      const double next = energy_of(*world, *model);
      // a chain that isn't damped keeps its energy to 1e-4 of it in a step
      ASSERT_LE(next, energy + (damping < 0.01 ? 1e-4 : 1e-6) * first) << "step " << i;
      energy = next;
    }
    EXPECT_LT(energy, first);
  }
}

/// The step of a spring is a rotation by Omega with tan(Omega / 2) = w dt / 2 in the plane of displacement and
/// velocity.
TEST_P(PassiveJoints, ASpringSwingsAndKeepsItsEnergyWhateverItsStiffness) {
  for (const double ratio : {0.01, 0.1, 1.0, 5.0})  // natural frequency w times time step
    for (const OneJoint& robot : one_joint_robots([&](Joint&joint, double inertia) {
           joint.spring_stiffness = ratio * ratio * inertia / (step * step);
           joint.spring_reference = 0.001;
         })) {
      SCOPED_TRACE(std::string(robot.name) + ", " + std::to_string(ratio));
      const auto world = make_world(settings(), {body_of(robot.model)});
      const double turn = 2.0 * std::atan(0.5 * ratio);  // per step [rad]
      double widest = 0.0;
      for (int tick = 1; tick <= 400; ++tick) {
        let_go(*world, 1);
        const double aside = joint_of(*world).q - 0.001;
        widest = std::max(widest, std::abs(aside));
        if (tick <= 100) {
          // q follows a cosine of that frequency, whose phase is half a step behind
          const double paper = -0.001 * std::cos(turn * (tick + 0.5)) / std::cos(0.5 * turn);
          ASSERT_NEAR(aside, paper, 2e-5) << tick;
        }
      }
      EXPECT_LT(widest, 0.001 / std::cos(0.5 * turn) * 1.01);
    }
}

TEST_P(PassiveJoints, ADampedSpringRestsWhereSpringAndWeightAreInBalance) {
  RobotBuilder slider(JointType::fixed);
  Joint& joint = slider.add("SLED", 0, JointType::prismatic, Vector3d::UnitZ(), inertial(3.0, {1, 1, 1}));
  joint.spring_stiffness = 600.0;
  joint.spring_reference = 0.1;
  joint.damping = 60.0;
  WorldSettings heavy = settings();
  heavy.gravity.z() = -standard_gravity;
  const auto world = make_world(heavy, {body_of(slider.build())});
  let_go(*world, 3000);
  EXPECT_NEAR(joint_of(*world).q, 0.1 - 3.0 * standard_gravity / 600.0, 1e-6);
  EXPECT_NEAR(joint_of(*world).u, 0.0, 1e-9);
}

TEST_P(PassiveJoints, ARotorAddsToTheInertia) {
  for (const double share : {0.1, 1.0, 10.0})
    for (const OneJoint& robot :
         one_joint_robots([&](Joint&joint, double inertia) { joint.armature = share * inertia; })) {
      SCOPED_TRACE(std::string(robot.name) + ", " + std::to_string(share));
      const auto world = make_world(settings(), {body_of(robot.model)});
      run(*world, 100, effort(2.0 * robot.inertia));
      EXPECT_NEAR(joint_of(*world).dq, 0.1 * 2.0 / (1.0 + share), 1e-3 / (1.0 + share));
      const double speed = joint_of(*world).dq;
      let_go(*world, 100);
      EXPECT_NEAR(joint_of(*world).dq, speed, 1e-4);  // it isn't damped
    }
}

TEST_P(PassiveJoints, AForceSensorMeasuresDampingAndRotor) {
  RobotBuilder robot(JointType::fixed);
  Joint& joint = robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitZ(), inertial(1.0, {0.3, 0.3, 0.5}));
  joint.damping = 2.0;
  joint.armature = 0.25;
  robot.add_device("Sensor", 1, ForceSensor{});
  const auto world = make_world(settings(), {body_of(robot.build())});
  run(*world, 200, effort(3.0));
  // the sensor lies behind the actuator, the damper and the rotor: it measures what the wheel needs
  EXPECT_NEAR(device_of(*world, 0)[5], -0.5 * joint_of(*world).ddq, 1e-6);
  EXPECT_GT(joint_of(*world).ddq, 1.0);
}

}  // namespace
}  // namespace rehearse
