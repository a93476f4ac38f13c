// Actuators of joints against their closed forms: a wheel of inertia I on a fixed base, without gravity.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>

#include "robots.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double tick = 0.001;  // [s]

class Actuators : public EachSolver {
 protected:
  WorldSettings still() const { return weightless(GetParam()); }

  std::unique_ptr<World> wheel(const std::function<void(Actuator&)>& describe, double start = 0.0) const {
    RobotBuilder robot(JointType::fixed);
    robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
    WorldBody body = body_of(robot.build());
    body.joints[0] = start;
    describe(body.actuators.emplace_back(Actuator{}).value());
    return make_world(still(), {body});
  }
};
INSTANTIATE_TEST_SUITE_P(Solver, Actuators, each_solver, solver_name);

const ActuatorReading& actuator_of(const World& world) { return world.sense().bodies[0].actuators[0]; }

// On paper: v(t) = u (t - delay) / I.
TEST_P(Actuators, ADelayActsToAPartOfAStep) {
  for (const double delay : {0.0, 0.0004, 0.001, 0.006, 0.00625}) {
    SCOPED_TRACE(delay);
    const auto world = wheel([&](Actuator& actuator) { actuator.delay = delay; });
    for (int i = 1; i <= 20; ++i) {
      run(*world, 1, effort(3.0));
      ASSERT_NEAR(joint_of(*world).dq, 3.0 / wheel_inertia * std::max(0.0, i * tick - delay), 1e-12);
    }
  }
}

TEST_P(Actuators, ADelayedDisplacementStartsAtTheInitialOne) {
  const auto world = wheel([](Actuator& actuator) { actuator.delay = 0.003; }, 0.4);
  for (int i = 1; i <= 10; ++i) {
    run(*world, 1, displacement(0.4 + 0.001 * i));
    ASSERT_NEAR(joint_of(*world).q, 0.4 + 0.001 * std::max(0, i - 3), 1e-7);
  }
}

// The mean of a ramp that is delayed evenly between 1 and 3 ms lags by 2 ms; a single command by 1 to 3.
TEST_P(Actuators, JitterSpreadsTheDelayEvenly) {
  const auto world = wheel([](Actuator& actuator) {
    actuator.delay = 0.002;
    actuator.jitter = 0.001;
    actuator.key = 7;
  });
  double sum = 0.0, least = 1.0, most = 0.0;
  constexpr int steps = 4000;
  for (int i = 0; i < steps; ++i) {
    run(*world, 1, effort(i * tick));
    if (i < 10) continue;
    const double lag = (i + 0.5) * tick - (actuator_of(*world).wanted + 0.5 * tick);
    sum += lag;
    least = std::min(least, lag);
    most = std::max(most, lag);
  }
  EXPECT_GT(most - least, 0.001);
  EXPECT_GT(least, 0.0005);
  EXPECT_LT(most, 0.003);
  // a newer command that overtakes shortens the mean lag below 2 ms
  EXPECT_NEAR(sum / (steps - 10), 0.0019, 0.0002);
}

TEST_P(Actuators, JitterDependsOnTheKeyAlone) {
  const auto last = [&](std::uint64_t key) {
    const auto world = wheel([&](Actuator& actuator) {
      actuator.delay = actuator.jitter = 0.002;
      actuator.key = key;
    });
    for (int i = 0; i < 100; ++i) run(*world, 1, effort(std::sin(0.1 * i)));
    return joint_of(*world).dq;
  };
  EXPECT_EQ(last(1), last(1));
  EXPECT_NE(last(1), last(2));
}

// On paper: u(t) = u0 (1 - exp(-t / T)), I v(t) = u0 (t - T (1 - exp(-t / T))), T = 1 / (2 pi f).
TEST_P(Actuators, ABandwidthIsAFirstOrderLag) {
  for (const double bandwidth : {0.01, 4.0, 40.0, 1000.0}) {
    SCOPED_TRACE(bandwidth);
    const auto world = wheel([&](Actuator& actuator) { actuator.bandwidth = bandwidth; });
    const double T = 1.0 / (2.0 * pi * bandwidth);
    for (int i = 1; i <= 50; ++i) {
      run(*world, 1, effort(3.0));
      const double t = i * tick;
      ASSERT_NEAR(joint_of(*world).dq, 3.0 / wheel_inertia * (t + T * std::expm1(-t / T)), 1e-10);
    }
  }
}

TEST_P(Actuators, CommandsAreMultiplesOfTheQuantum) {
  const auto world = wheel([](Actuator& actuator) { actuator.quantum = 0.25; });
  run(*world, 1, effort(0.9));
  EXPECT_EQ(joint_of(*world).u, 1.0);
  run(*world, 1, effort(-0.1));
  EXPECT_EQ(joint_of(*world).u, 0.0);
  run(*world, 1, velocity(0.3));
  EXPECT_NEAR(joint_of(*world).dq, 0.25, 1e-7);
}

// On paper the line of the motor meets the load where stall (1 - w / w0) = load, and is reached with the time constant
// I w0 / stall; the velocity at a step's beginning makes that of N steps (1 - h / T)^N.
TEST_P(Actuators, TheTorqueSpeedLineMeetsTheLoad) {
  constexpr double stall = 35.0, no_load = 30.0, load = 14.0;
  const auto world = wheel([&](Actuator& actuator) {
    actuator.stall_effort = stall;
    actuator.no_load_velocity = no_load;
  });
  const double meet = no_load * (1.0 - load / stall), T = wheel_inertia * no_load / stall;
  Command command = idle(*world);
  command.bodies[0].joints[0] = effort(1000.0);
  for (int i = 1; i <= 4000; ++i) {
    command.bodies[0].external[1].torque = {0.0, -load, 0.0};
    world->actuate(command);
    ASSERT_TRUE(world->step());
    ASSERT_NEAR(joint_of(*world).dq, meet * -std::expm1(-i * tick / T), 1e-5);
  }
  EXPECT_NEAR(joint_of(*world).dq, meet, 0.002);
  EXPECT_EQ(actuator_of(*world).wanted, 1000.0);
  EXPECT_NEAR(actuator_of(*world).effort, load, 0.01);
}

/// A line that falls by more than the inertia can take in a step.
TEST_P(Actuators, ASteepTorqueSpeedLineIsStable) {
  const auto world = wheel([](Actuator& actuator) {
    actuator.stall_effort = 500.0;
    actuator.no_load_velocity = 0.5;
  });
  for (int i = 0; i < 100; ++i) {
    run(*world, 1, effort(1000.0));
    ASSERT_LE(joint_of(*world).dq, 0.5 + 1e-9);
  }
  EXPECT_NEAR(joint_of(*world).dq, 0.5, 1e-6);
}

TEST_P(Actuators, TheMotorHasFourQuadrants) {
  const struct {
    double velocity, wanted, effort;
  } cases[] = {{15.0, 100.0, 17.5}, {15.0, -100.0, -40.0}, {-15.0, 100.0, 40.0}, {-15.0, -100.0, -17.5},
               {15.0, 10.0, 10.0},  {36.0, 100.0, -7.0},   {-36.0, -100.0, 7.0}, {0.0, 100.0, 35.0}};
  for (const auto& quadrant : cases) {
    SCOPED_TRACE(quadrant.velocity);
    const auto world = wheel([](Actuator& actuator) {
      actuator.stall_effort = 35.0;
      actuator.no_load_velocity = 30.0;
      actuator.effort = 40.0;
    });
    run(*world, 1, velocity(quadrant.velocity));  // a drive without loop: as strong as a motor that accelerates
    while (std::abs(joint_of(*world).dq - quadrant.velocity) > 1e-6 && std::abs(quadrant.velocity) < 30.0)
      run(*world, 1, velocity(quadrant.velocity));
    if (std::abs(quadrant.velocity) > 30.0) {  // faster than the motor can turn: pushed from outside
      Command command = idle(*world);
      const double missing = quadrant.velocity - joint_of(*world).dq;
      command.bodies[0].external[1].torque = {0.0, missing * wheel_inertia / tick, 0.0};
      world->actuate(command);
      ASSERT_TRUE(world->step());
      command.bodies[0].external[1].torque.setZero();
      const double braked = quadrant.velocity - joint_of(*world).dq;  // by the motor in that step
      command.bodies[0].external[1].torque = {0.0, braked * wheel_inertia / tick, 0.0};
    }
    const double at = joint_of(*world).dq;
    run(*world, 1, effort(quadrant.wanted));
    Actuator limits;
    limits.effort = 40.0;
    limits.stall_effort = 35.0;
    limits.no_load_velocity = 30.0;
    // the mean over the step, whose velocity changes
    const EffortRange range = effort_range(limits, 0.5 * (at + joint_of(*world).dq));
    EXPECT_NEAR(actuator_of(*world).effort, std::clamp(quadrant.wanted, range.lower, range.upper), 1e-3);
    const EffortRange exact = effort_range(limits, quadrant.velocity);
    EXPECT_NEAR(std::clamp(quadrant.wanted, exact.lower, exact.upper), quadrant.effort, 1e-12);
  }
}

// On paper the sampled loop of an inertia, x'' = (kp (q* - x) - kd x') / I with the effort held for n steps, is the
// product of its matrices; here it is computed once more in scalars.
TEST_P(Actuators, TheDrivesOwnLoopRunsAtItsOwnPeriod) {
  constexpr double kp = 40.0, kd = 4.0;
  for (const int every : {1, 5}) {
    SCOPED_TRACE(every);
    const auto world = wheel([&](Actuator& actuator) {
      actuator.position_gain = kp;
      actuator.velocity_gain = kd;
      actuator.period = every * tick;
    });
    double x = 0.0, v = 0.0, u = 0.0;
    for (int i = 0; i < 1000; ++i) {
      if (i % every == 0) u = kp * (0.2 - x) - kd * v;
      run(*world, 1, displacement(0.2));
      v += tick * u / wheel_inertia;
      x += tick * v;
      ASSERT_NEAR(joint_of(*world).q, x, 1e-7);
      ASSERT_NEAR(joint_of(*world).u, u, 1e-5);
    }
    EXPECT_NEAR(x, 0.2, 0.02);
  }
}

TEST_P(Actuators, TheDrivesOwnLoopFollowsAVelocity) {
  const auto world = wheel([](Actuator& actuator) { actuator.velocity_gain = 5.0; });
  run(*world, 300, velocity(2.0));  // on paper: 2 (1 - (1 - kd h / I)^n)
  EXPECT_NEAR(joint_of(*world).dq, 2.0 * (1.0 - std::pow(1.0 - 5.0 * tick / wheel_inertia, 300)), 1e-7);
}

TEST_P(Actuators, TheRotorCountsAsInertia) {
  const auto world = wheel([](Actuator& actuator) { actuator.armature = 0.25; });
  run(*world, 100, effort(3.0));
  EXPECT_NEAR(joint_of(*world).dq, 3.0 * 0.1 / (wheel_inertia + 0.25), 1e-6);
}

TEST_P(Actuators, DampingSlowsExponentially) {
  const auto world = wheel([](Actuator& actuator) { actuator.damping = 0.6; });
  run(*world, 1, velocity(2.0));
  let_go(*world, 500);
  EXPECT_NEAR(joint_of(*world).dq, 2.0 * std::exp(-0.6 / wheel_inertia * 0.5), 1e-6);
}

// On paper a wheel that turns with v stops after v² I / (2 F), in v I / F.
TEST_P(Actuators, CoulombFrictionStopsAWheelAtItsDistance) {
  constexpr double friction = 1.0, first = 0.5;
  const auto world = wheel([&](Actuator& actuator) { actuator.coulomb = friction; });
  run(*world, 1, velocity(first));
  const double begin = joint_of(*world).q;
  let_go(*world, 1000);
  EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-9);
  const double distance = first * first * wheel_inertia / (2.0 * friction);
  EXPECT_NEAR(joint_of(*world).q - begin, distance, 0.5 * first * tick + 1e-5);  // half a step of its first velocity
}

TEST_P(Actuators, StictionHoldsUntilItBreaks) {
  const auto describe = [](Actuator& actuator) {
    actuator.coulomb = 1.0;
    actuator.stiction = 2.0;
    actuator.stribeck = 0.1;
  };
  const auto held = wheel(describe);
  run(*held, 1000, effort(1.99));
  EXPECT_NEAR(joint_of(*held).q, 0.0, 1e-4);
  const auto broken = wheel(describe);
  run(*broken, 500, effort(2.05));
  const double late = joint_of(*broken).dq;
  run(*broken, 100, effort(2.05));
  EXPECT_NEAR(joint_of(*broken).dq - late, (2.05 - 1.0) / wheel_inertia * 0.1, 1e-5);  // only Coulomb's is left
}

// Friction at a velocity is what a drive needs to keep it: F = coulomb + (stiction - coulomb) exp(-(v / stribeck)²).
TEST_P(Actuators, StribecksCurveJoinsStictionAndCoulomb) {
  for (const double v : {0.02, 0.05, 0.1, 0.2, 1.0}) {
    SCOPED_TRACE(v);
    const auto world = wheel([](Actuator& actuator) {
      actuator.coulomb = 1.0;
      actuator.stiction = 2.0;
      actuator.stribeck = 0.1;
    });
    run(*world, 1, velocity(v));
    let_go(*world, 1);
    EXPECT_NEAR((v - joint_of(*world).dq) * wheel_inertia / tick, 1.0 + std::exp(-v * v / 0.01), 1e-3);
  }
}

// A load of L: the motor lifts it from L / e on, and it turns the motor back only below L e.
TEST_P(Actuators, EfficiencyDependsOnTheDirectionOfPower) {
  constexpr double e = 0.8, load = 10.0;
  const auto acceleration = [&](double u) {
    const auto world = wheel([&](Actuator& actuator) { actuator.efficiency = e; });
    Command command = idle(*world);
    command.bodies[0].joints[0] = effort(u);
    for (int i = 0; i < 100; ++i) {
      command.bodies[0].external[1].torque = {0.0, -load, 0.0};
      world->actuate(command);
      EXPECT_TRUE(world->step());
    }
    return joint_of(*world).dq / 0.1;
  };
  EXPECT_NEAR(acceleration(15.0), (15.0 * e - load) / wheel_inertia, 0.01 * 15.0 * e / wheel_inertia + 1e-3);
  EXPECT_NEAR(acceleration(12.4), 0.0, 0.15);  // 10 / 0.8 = 12.5
  EXPECT_NEAR(acceleration(8.1), 0.0, 0.15);   // 10 * 0.8 = 8
  EXPECT_NEAR(acceleration(6.0), (6.0 / e - load) / wheel_inertia, 0.01 * load / wheel_inertia + 1e-3);
}

// A rotor that a stiff loop holds: the wheel turns freely by the gap, and no further than the teeth give way.
TEST_P(Actuators, BacklashLeavesTheWheelFreeWithinItsGap) {
  constexpr double gap = 0.02, stiffness = 1e4, push = 5.0;
  const auto world = wheel([&](Actuator& actuator) {
    actuator.backlash = gap;
    actuator.contact_stiffness = stiffness;
    actuator.contact_damping = 20.0;
    actuator.armature = 0.1;
  });
  const auto settled = [&](double torque) {
    Command command = idle(*world);
    command.bodies[0].joints[0] = displacement(0.0);  // an ideal drive: it holds the rotor
    for (int i = 0; i < 3000; ++i) {
      command.bodies[0].external[1].torque = {0.0, torque, 0.0};
      world->actuate(command);
      EXPECT_TRUE(world->step());
    }
    EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-6);
    EXPECT_NEAR(joint_of(*world).u, -torque, 1e-3);
    return joint_of(*world).q;
  };
  EXPECT_NEAR(settled(push), 0.5 * gap + push / stiffness, 1e-7);
  EXPECT_NEAR(settled(-push), -0.5 * gap - push / stiffness, 1e-7);
}

// While the teeth push, rotor and wheel accelerate as one; within the gap the rotor alone.
TEST_P(Actuators, ARotorCrossesItsGapAlone) {
  constexpr double gap = 0.02, rotor = 0.1, u = 2.0;
  const auto world = wheel([&](Actuator& actuator) {
    actuator.backlash = gap;
    actuator.armature = rotor;
  });
  int steps = 0;
  for (; joint_of(*world).dq == 0.0 && steps < 200; ++steps) run(*world, 1, effort(u));
  const double crossing = std::sqrt(2.0 * 0.5 * gap / (u / rotor));  // half the gap: it begins in the middle
  EXPECT_NEAR(steps * tick, crossing, 2.0 * tick);
  run(*world, 400, effort(u));
  const double before = joint_of(*world).dq;
  run(*world, 100, effort(u));
  EXPECT_NEAR((joint_of(*world).dq - before) / 0.1, u / (wheel_inertia + rotor), 0.01);
  EXPECT_NEAR(joint_of(*world).u, u * wheel_inertia / (wheel_inertia + rotor), 0.02);
  // momentum on paper: all of it came from the motor
  const double momentum = rotor * actuator_of(*world).dq + wheel_inertia * joint_of(*world).dq;
  EXPECT_NEAR(momentum, u * tick * (steps + 500), 1e-4);
}

TEST_P(Actuators, AStateHasTheCommandsUnderWay) {
  const auto make = [&] {
    return wheel([](Actuator& actuator) {
      actuator.delay = 0.0055;
      actuator.jitter = 0.001;
      actuator.bandwidth = 30.0;
      actuator.backlash = 0.01;
      actuator.armature = 0.05;
      actuator.efficiency = 0.9;
      actuator.stiction = 0.2;
      actuator.position_gain = 100.0;
      actuator.velocity_gain = 3.0;
      actuator.period = 0.003;
    });
  };
  const auto world = make(), other = make();
  const auto drive = [](World& of, int from, int to) {
    for (int i = from; i < to; ++i) run(of, 1, displacement(0.3 * std::sin(0.02 * i)));
  };
  drive(*world, 0, 100);
  const auto state = world->save();
  drive(*world, 100, 200);
  ASSERT_TRUE(other->restore(state));
  drive(*other, 100, 200);
  EXPECT_EQ(other->state_hash(), world->state_hash());
}

TEST_P(Actuators, AWorldWithOtherActuatorsTakesTheState) {
  const auto world = wheel([](Actuator& actuator) { actuator.delay = 0.006; });
  run(*world, 50, effort(1.0));
  for (const double delay : {0.002, 0.006, 0.01}) {
    SCOPED_TRACE(delay);
    const auto other = wheel([&](Actuator& actuator) {
      actuator.delay = delay;
      actuator.backlash = 0.01;
      actuator.armature = 0.1;
    });
    const auto taken = other->take_state(*world);
    ASSERT_TRUE(taken.ok()) << to_string(taken.errors());
    EXPECT_EQ(joint_of(*other).dq, joint_of(*world).dq);
    run(*other, 1, effort(1.0));
    EXPECT_EQ(actuator_of(*other).wanted, delay <= 0.006 ? 1.0 : 0.0);
  }
}

TEST_P(Actuators, AnActuatorWithoutPropertiesChangesNoMotion) {
  const auto ideal = [&] {
    RobotBuilder robot(JointType::fixed);
    robot.add("WHEEL", 0, JointType::continuous, Vector3d::UnitY(), inertial(1.0, Vector3d::Constant(wheel_inertia)));
    return make_world(still(), {body_of(robot.build())});
  }();
  const auto world = wheel([](Actuator&) {});
  for (int i = 0; i < 100; ++i) {
    const JointCommand command = i < 50 ? effort(0.1 * i) : displacement(0.001 * i);
    run(*ideal, 1, command);
    run(*world, 1, command);
    ASSERT_EQ(joint_of(*world).q, joint_of(*ideal).q);
    ASSERT_EQ(joint_of(*world).u, joint_of(*ideal).u);
  }
}

// On paper the heat of a constant effort is u² (1 - exp(-t / T)). It exceeds c² at t = -T ln(1 - c² / u²).
TEST_P(Actuators, AConstantEffortIsLimitedOnceItHasHeatedTheMotor) {
  constexpr double continuous = 2.0, time_constant = 0.3;
  for (const double u : {2.2, 3.0, 8.0}) {
    SCOPED_TRACE(u);
    const auto world = wheel([&](Actuator& actuator) {
      actuator.continuous_effort = continuous;
      actuator.thermal_time = time_constant;
    });
    const double hot = -time_constant * std::log(1.0 - continuous * continuous / (u * u));
    for (int i = 0; i < 800; ++i) {
      run(*world, 1, effort(u));
      ASSERT_EQ(actuator_of(*world).wanted, u);
      ASSERT_EQ(actuator_of(*world).effort, i * tick > hot ? continuous : u) << i;
      ASSERT_EQ(std::isfinite(actuator_of(*world).thermal_limit), i * tick > hot);
    }
  }
}

// On paper the heat falls from x to u² + (x - u²) exp(-t / T). The peak is back below (0.9 c)².
TEST_P(Actuators, AMotorThatHasCooledHasItsPeakEffortAgain) {
  constexpr double continuous = 2.0, time_constant = 0.3, peak = 4.0, rest = 1.0;
  const auto world = wheel([&](Actuator& actuator) {
    actuator.continuous_effort = continuous;
    actuator.thermal_time = time_constant;
  });
  run(*world, 1000, effort(peak));
  const int heated = static_cast<int>(-time_constant * std::log(1.0 - 0.25) / tick) + 1;  // steps with the peak
  const double at_limit = peak * peak * -std::expm1(-heated * tick / time_constant);
  const double budget = continuous * continuous;
  const double x = budget + (at_limit - budget) * std::exp(-(1000 - heated) * tick / time_constant);
  const double cooled = time_constant * std::log((x - rest * rest) / (0.81 * budget - rest * rest));
  int steps = 0;
  for (; std::isfinite(actuator_of(*world).thermal_limit) && steps < 1000; ++steps) run(*world, 1, effort(rest));
  EXPECT_EQ(steps, static_cast<int>(cooled / tick) + 2);  // the first step that begins after it
  run(*world, 1, effort(peak));
  EXPECT_EQ(actuator_of(*world).effort, peak);
}

// A drive without a loop heats its motor by what its motion needs, and then is limited alike.
TEST_P(Actuators, ADriveWithoutALoopGetsHotToo) {
  constexpr double continuous = 2.0, time_constant = 0.1, load = 3.0;
  const auto world = wheel([&](Actuator& actuator) {
    actuator.effort = 10.0;
    actuator.continuous_effort = continuous;
    actuator.thermal_time = time_constant;
  });
  const double hot = -time_constant * std::log(1.0 - continuous * continuous / (load * load));
  Command command = idle(*world);
  command.bodies[0].joints[0] = velocity(0.0);
  for (int i = 0; i < 200; ++i) {
    command.bodies[0].external[1].torque = {0.0, -load, 0.0};
    world->actuate(command);
    ASSERT_TRUE(world->step());
    ASSERT_NEAR(actuator_of(*world).effort, i * tick > hot ? continuous : load, 1e-6) << i;
  }
  const double slipped = (load - continuous) / wheel_inertia * tick * (199 - std::floor(hot / tick));
  EXPECT_NEAR(joint_of(*world).dq, -slipped, 1e-6);
}

TEST_P(Actuators, AStateHasTheHeat) {
  const auto make = [&] {
    return wheel([](Actuator& actuator) {
      actuator.continuous_effort = 2.0;
      actuator.thermal_time = 0.2;
      actuator.faults = {{ActuatorFault::Kind::locked, 1.0, 0.09, 0.12}};
    });
  };
  const auto world = make(), restored = make(), taken = make();
  run(*world, 100, effort(3.0));
  const auto state = world->save();
  ASSERT_TRUE(restored->restore(state));
  ASSERT_TRUE(taken->take_state(*world));
  for (World* each : {world.get(), restored.get(), taken.get()}) run(*each, 100, effort(3.0));
  EXPECT_TRUE(std::isfinite(actuator_of(*world).thermal_limit));
  EXPECT_EQ(restored->state_hash(), world->state_hash());
  EXPECT_EQ(taken->state_hash(), world->state_hash());
}

// A branch into a world whose actuators have more than those of the recording: what the recording has goes on.
TEST_P(Actuators, AWorldWithFaultsAndHeatTakesTheCommandsUnderWay) {
  const auto world = wheel([](Actuator& actuator) { actuator.delay = 0.006; });
  run(*world, 50, effort(1.0));
  const auto other = wheel([](Actuator& actuator) {
    actuator.delay = 0.006;
    actuator.continuous_effort = 2.0;
    actuator.thermal_time = 0.2;
    actuator.faults = {{ActuatorFault::Kind::locked, 1.0, 1.0, 2.0}};
  });
  ASSERT_TRUE(other->take_state(*world));
  run(*world, 5, effort(2.0));
  run(*other, 5, effort(2.0));
  EXPECT_EQ(actuator_of(*other).wanted, 1.0);
  EXPECT_EQ(joint_of(*other).dq, joint_of(*world).dq);
}

ActuatorFault fault_of(ActuatorFault::Kind kind, double share = 1.0) { return {kind, share, 0.01, 0.02}; }

// On paper: v = h sum(u) / I.
TEST_P(Actuators, AFaultChangesTheEffortWhileItLasts) {
  using enum ActuatorFault::Kind;
  for (const auto& [kind, share, factor] :
       {std::tuple(dead, 1.0, 0.0), std::tuple(weak, 0.4, 0.4), std::tuple(reversed, 1.0, -1.0)}) {
    const auto world =
        wheel([&, of = kind, left = share](Actuator& actuator) { actuator.faults = {fault_of(of, left)}; });
    run(*world, 30, effort(3.0));
    EXPECT_NEAR(joint_of(*world).dq, 3.0 / wheel_inertia * tick * (20 + 10 * factor), 1e-12);
  }
}

TEST_P(Actuators, ALockedJointStaysWhereItIs) {
  const auto world = wheel([](Actuator& actuator) { actuator.faults = {fault_of(ActuatorFault::Kind::locked)}; });
  run(*world, 10, effort(3.0));
  const double locked_at = joint_of(*world).q;
  run(*world, 9, effort(3.0));
  EXPECT_NEAR(joint_of(*world).q, locked_at, 1e-9);
  EXPECT_NEAR(joint_of(*world).dq, 0.0, 1e-9);
  run(*world, 11, effort(3.0));
  EXPECT_NEAR(joint_of(*world).dq, 3.0 / wheel_inertia * tick * 10, 1e-9);
}

}  // namespace
}  // namespace rehearse
