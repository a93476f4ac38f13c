// Swings a pendulum up with a motor that is too weak to lift it, and balances it at the top.
//
// Swinging up: a torque along the motion adds energy, a torque against it removes energy. Far from the top the torque
// is the missing energy times a gain, in the direction of the motion (K. J. Åström, K. Furuta: Swinging up a pendulum
// by energy control, 2000).
//
// Balancing: with x the angle from the upright and w² = m g l / J the pendulum falls like J x'' = m g l x + u. The
// unstable mode is x + x' / w; the motor can stabilise it as long as it is below u_max / (m g l). State feedback u =
// -(m g l + J p²) x - 2 J p x' puts both poles at -p.
//
// All parameters come from the model: mass, centre of mass, inertia, and the effort limit, which only this controller
// enforces.

#include <algorithm>
#include <cmath>
#include <cnoid/MathUtil>
#include <cnoid/SimpleController>

namespace {

constexpr double gravity = 9.80665;    // [m/s²]
constexpr double energy_gain = 2.0;    // torque per missing energy [1/rad]
constexpr double pole = 8.0;           // [rad/s]
constexpr double hold_share = 0.8;     // share of the motor's largest stabilisable deviation at which balancing begins
constexpr double near_upright = 0.5;   // where sin(x) is about x [rad]
constexpr double resting_rate = 0.01;  // [rad/s]

class PendulumSwingUpController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    hinge_ = io->body()->joint("HINGE");
    if (!hinge_ || !hinge_->hasJointEffortLimits()) {
      io->os() << io->controllerName() << " needs a joint HINGE with an effort limit\n";
      return false;
    }
    const double length = hinge_->c().norm();  // from the hinge to the centre of mass [m]
    inertia_ = hinge_->a().dot(hinge_->I() * hinge_->a()) + hinge_->m() * length * length;
    weight_torque_ = hinge_->m() * gravity * length;
    hinge_->setActuationMode(JointTorque);
    io->enableInput(hinge_, JointAngle | JointVelocity);
    io->enableOutput(hinge_);
    return true;
  }

  bool control() override {
    // the angle counts its turns; only the rest modulo full turns matters
    const double x = std::remainder(hinge_->q() - cnoid::PI, 2.0 * cnoid::PI);
    const double dx = hinge_->dq();
    const double growing = x + dx * std::sqrt(inertia_ / weight_torque_);
    const bool balances =
        std::abs(x) < near_upright && std::abs(growing) < hold_share * hinge_->u_upper() / weight_torque_;
    const double u = balances ? balance(x, dx) : swing(x, dx);
    hinge_->u() = std::clamp(u, hinge_->u_lower(), hinge_->u_upper());
    return true;
  }

 private:
  double balance(double x, double dx) const {
    return -(weight_torque_ + inertia_ * pole * pole) * x - 2.0 * inertia_ * pole * dx;
  }

  /// Swinging-up torque. The energy is zero at rest at the top.
  double swing(double x, double dx) const {
    const double energy = 0.5 * inertia_ * dx * dx + weight_torque_ * (std::cos(x) - 1.0);  // [J]
    const double direction = dx < -resting_rate ? -1.0 : 1.0;  // at rest, towards the positive side
    return -energy_gain * energy * direction;
  }

  cnoid::Link* hinge_ = nullptr;
  double inertia_ = 0.0;        // about the hinge [kg·m²]
  double weight_torque_ = 0.0;  // of the weight when level: m g l [N·m]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PendulumSwingUpController)
