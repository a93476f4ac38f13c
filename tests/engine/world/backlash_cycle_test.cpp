// The limit cycle of a loop around a gear with backlash, against its closed form.
#include <rehearse/actuator.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "robots.h"

namespace rehearse {
namespace {

class BacklashCycle : public EachSolver {};
INSTANTIATE_TEST_SUITE_P(Solver, BacklashCycle, each_solver, solver_name);

// A drive turns the rotor with the velocity -(2 ζ ω q + ω² ∫ q dt), from the displacement q of the load. Friction holds
// the load while the rotor crosses the gap b. On paper, in the time τ = ω t and with q in amplitudes A:
// - the load stops at q = 1, the rotor turns back with the acceleration -1, and meets the load with the velocity -r
//   after the time r, where r²/2 = b / A;
// - together they are q'' + 2 ζ q' + q = 0 from q = 1, q' = -r until q' = 0 after the time T, where
//   tan(ν T) = ν r / (ζ r - 1), ν² = 1 - ζ², and q = -exp(-ζ T) sqrt(1 - 2 ζ r + r²);
// - in the cycle that is -1, which determines r. So A = 2 b / r², and a period is 2 (r + T) / ω.
struct CycleOnPaper {
  explicit CycleOnPaper(double damping) {
    const double nu = std::sqrt(1.0 - damping * damping);
    double low = 1e-6, high = 10.0;  // a cycle with r too small grows, one with r too large shrinks
    for (int i = 0; i < 60; ++i) {
      meeting = 0.5 * (low + high);
      together = std::atan2(nu * meeting, damping * meeting - 1.0) / nu;
      const double next = std::exp(-damping * together) * std::sqrt(1.0 - 2.0 * damping * meeting + meeting * meeting);
      (next < 1.0 ? low : high) = meeting;
    }
  }
  double amplitude(double gap) const { return 2.0 * gap / (meeting * meeting); }
  double period(double pace) const { return 2.0 * (meeting + together) / pace; }

  double meeting = 0.0;   // r
  double together = 0.0;  // T
};

TEST_P(BacklashCycle, AnIntegratingLoopKeepsItsAmplitudeAndPeriod) {
  constexpr double time_step = 0.001, gap = 0.02, stiffness = 1e6, friction = 1.0, pace = 3.0;
  for (const double damping : {0.1, 0.3, 0.6}) {
    SCOPED_TRACE(damping);
    RobotBuilder robot(JointType::fixed);
    robot.add("WHEEL", 0, JointType::continuous, Eigen::Vector3d::UnitY(),
              inertial(1.0, Eigen::Vector3d::Constant(wheel_inertia)));
    WorldBody body = body_of(robot.build());
    const CycleOnPaper paper(damping);
    const double lost = gap + 2.0 * friction / stiffness;  // the teeth give way by friction / stiffness on both sides
    body.joints[0] = 0.7 * paper.amplitude(lost);
    Actuator& actuator = body.actuators.emplace_back(Actuator{}).value();
    actuator.backlash = gap;
    actuator.contact_stiffness = stiffness;
    actuator.armature = 0.1;
    actuator.coulomb = friction;
    const auto world = make_world(weightless(GetParam()), {body});

    double sum = 0.0, last = body.joints[0], crossed = 0.0, largest = 0.0;
    std::vector<double> amplitudes, periods;
    const int steps = static_cast<int>(30.0 * paper.period(pace) / time_step);
    for (int i = 1; i <= steps; ++i) {
      // in the middle of the step, to which the command belongs
      const double q = joint_of(*world).q + 0.5 * time_step * joint_of(*world).dq;
      sum += time_step * joint_of(*world).q;
      run(*world, 1,
          velocity(-(2.0 * damping * pace * q + pace * pace * (sum - 0.5 * time_step * joint_of(*world).q))));
      const double now = joint_of(*world).q;
      largest = std::max(largest, now);
      if (last < 0.0 && now >= 0.0) {
        const double at = time_step * (i - now / (now - last));
        amplitudes.push_back(largest);
        periods.push_back(at - crossed);
        crossed = at;
        largest = 0.0;
      }
      last = now;
    }
    ASSERT_GT(amplitudes.size(), 25u);
    EXPECT_NEAR(amplitudes.back() / paper.amplitude(lost), 1.0, 0.01);
    EXPECT_NEAR(periods.back() / paper.period(pace), 1.0, 0.001);
    EXPECT_LT(amplitudes[1], 0.95 * amplitudes.back()) << "it begins smaller, and grows";
  }
}

}  // namespace
}  // namespace rehearse
