// Swings a pendulum up with a motor that is too weak to lift it, by plans that a thread makes beside the loop.
//
// Every 20 ms control() asks for a plan from the present state, and goes on with the plan that it has. The planner
// changes that plan at random, simulates each candidate for a second with a model of the pendulum, and keeps the
// cheapest: predictive sampling (T. Howell et al., Predictive Sampling: Real-time Behaviour Synthesis with MuJoCo,
// 2022). Two tasks simulate half of the candidates each. With x the angle from the upright the model is
// J x'' = m g l sin x + u. Its parameters are those of the robot's model.

#include <pthread.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cnoid/MathUtil>
#include <cnoid/SimpleController>
#include <condition_variable>
#include <cstddef>
#include <future>
#include <mutex>
#include <random>
#include <thread>
#include <utility>
#include <vector>

namespace {

constexpr double gravity = 9.80665;  // [m/s²]
constexpr double period = 0.02;      // between two plans [s]
constexpr double piece = 0.1;        // of a plan, with one torque [s]
constexpr double step = 0.01;        // of the model [s]
constexpr int steps_of_a_piece = 10;
constexpr int candidates = 40;

struct Plan {
  std::array<double, 10> torques{};  // of its pieces [N·m]
  double begin = 0.0;                // [s]

  double torque_at(double time) const {
    const auto number = static_cast<std::size_t>(std::max(0.0, (time - begin) / piece));
    return number < torques.size() ? torques[number] : 0.0;
  }
  /// The same torques, from a later time on.
  Plan from(double time) const {
    Plan rest{{}, time};
    for (std::size_t i = 0; i < torques.size(); ++i)
      rest.torques[i] = torque_at(time + (static_cast<double>(i) + 0.5) * piece);
    return rest;
  }
};

/// A pendulum with its motor.
struct Pendulum {
  double inertia = 0.0;        // about the hinge [kg·m²]
  double weight_torque = 0.0;  // of the weight when level: m g l [N·m]
  double limit = 0.0;          // of the motor [N·m]

  /// What the plan costs from the angle x [rad] and its rate on: missing energy, distance from the top, torque.
  double cost_of(const Plan& plan, double x, double dx) const {
    double cost = 0.0;
    for (const double torque : plan.torques)
      for (int i = 0; i < steps_of_a_piece; ++i) {
        dx += step * (weight_torque * std::sin(x) + torque) / inertia;
        x += step * dx;
        const double energy = 0.5 * inertia * dx * dx + weight_torque * (std::cos(x) - 1.0);  // 0: at rest at the top
        cost += step * (energy * energy + 0.2 * (1.0 - std::cos(x)) + 0.002 * torque * torque);
      }
    return cost + 3.0 * (1.0 - std::cos(x)) + 0.02 * dx * dx * (1.0 + std::cos(x));
  }
};

class PendulumPlanController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    hinge_ = io->body()->joint("HINGE");
    if (!hinge_ || !hinge_->hasJointEffortLimits()) {
      io->os() << io->controllerName() << " needs a joint HINGE with an effort limit\n";
      return false;
    }
    const double length = hinge_->c().norm();  // from the hinge to the centre of mass [m]
    pendulum_.inertia = hinge_->a().dot(hinge_->I() * hinge_->a()) + hinge_->m() * length * length;
    pendulum_.weight_torque = hinge_->m() * gravity * length;
    pendulum_.limit = hinge_->u_upper();
    hinge_->setActuationMode(JointTorque);
    io->enableInput(hinge_, JointAngle | JointVelocity);
    io->enableOutput(hinge_);
    return true;
  }

  bool start() override {
    planner_ = std::thread([this] { make_plans(); });
    return true;
  }

  bool control() override {
    const std::scoped_lock lock(mutex_);
    const double time = io_->currentTime();
    if (time >= next_plan_) {
      next_plan_ += period;
      asked_ = {std::remainder(hinge_->q() - cnoid::PI, 2.0 * cnoid::PI), hinge_->dq(), time};
      is_asked_ = true;
      woken_.notify_one();
    }
    hinge_->u() = plan_.torque_at(time);
    return true;
  }

  void stop() override {
    {
      const std::scoped_lock lock(mutex_);
      is_over_ = true;
    }
    woken_.notify_one();
    if (planner_.joinable()) planner_.join();
  }

 private:
  /// The state of which a plan is wanted.
  struct State {
    double x = 0.0, dx = 0.0;  // from the upright [rad], [rad/s]
    double time = 0.0;         // [s]
  };

  void make_plans() {
    pthread_setname_np(pthread_self(), "planner");
    std::unique_lock lock(mutex_);
    for (;;) {
      woken_.wait(lock, [this] { return is_asked_ || is_over_; });
      if (is_over_) return;
      is_asked_ = false;
      const State state = asked_;
      const Plan known = plan_;
      lock.unlock();
      const Plan better = improved(known.from(state.time), state);
      lock.lock();
      plan_ = better;
    }
  }

  /// The cheapest of the plan and of its changes.
  Plan improved(const Plan& known, const State& state) {
    std::vector<Plan> plans(candidates, known);
    for (std::size_t i = 1; i < plans.size(); ++i)
      for (double& torque : plans[i].torques) {
        if (i > 2) torque += pendulum_.limit * (2.0 * chance() - 1.0);
        if (i <= 2) torque = i == 1 ? pendulum_.limit : -pendulum_.limit;
        torque = std::clamp(torque, -pendulum_.limit, pendulum_.limit);
      }
    const auto cheapest = [&](std::size_t begin, std::size_t end) {
      std::pair<double, std::size_t> best{pendulum_.cost_of(plans[begin], state.x, state.dx), begin};
      for (std::size_t i = begin + 1; i < end; ++i)
        best = std::min(best, {pendulum_.cost_of(plans[i], state.x, state.dx), i});
      return best;
    };
    auto second = std::async(std::launch::async, cheapest, plans.size() / 2, plans.size());
    const auto first = cheapest(0, plans.size() / 2);
    return plans[std::min(first, second.get()).second];
  }

  /// From 0 to 1, the same with any standard library.
  double chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* hinge_ = nullptr;
  Pendulum pendulum_;
  double next_plan_ = 0.0;  // [s]
  std::thread planner_;
  std::mt19937_64 random_;  // of the planner alone
  std::mutex mutex_;        // of the members below
  std::condition_variable woken_;
  State asked_;
  bool is_asked_ = false, is_over_ = false;
  Plan plan_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PendulumPlanController)
