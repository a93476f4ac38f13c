#include "world_remarks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/clock.h"

namespace rehearse {
namespace {

/// No robot's joint is that fast: the simulation is about to explode [rad/s] or [m/s].
constexpr double most_speed = 1e4;

}  // namespace

WorldRemarks::WorldRemarks(const Scenario& scenario) : scenario_(scenario) {
  for (const ScenarioBody& body : scenario.bodies) {
    std::vector<JointRemarks>& joints = joints_.emplace_back();
    for (const int link : body.model->joints) {
      const Joint& joint = body.model->links[static_cast<std::size_t>(link)].joint;
      joints.push_back({joint.lower, joint.upper});
    }
  }
  sinking_.resize(scenario.bodies.size());
  limited_.resize(scenario.bodies.size());
  hot_.resize(scenario.bodies.size());
  for (const ScenarioBody& body : scenario.bodies) {
    std::vector<Joint>& joints = built_.emplace_back();
    for (std::size_t id = 0; id < body.actuators.size(); ++id) {
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      joints.push_back(body.actuators[id] ? joint_with(*body.actuators[id], joint) : joint);
    }
  }
}

const Joint& WorldRemarks::joint_of(std::size_t body, std::size_t id) const {
  if (!built_[body].empty()) return built_[body][id];
  const Model& model = *scenario_.bodies[body].model;
  return model.links[static_cast<std::size_t>(model.joints[id])].joint;
}

void WorldRemarks::add_idle_camera(const std::string& controller, int body, int device) {
  const ScenarioBody& owner = scenario_.bodies[static_cast<std::size_t>(body)];
  idle_cameras_.push_back(
      fmt::format("'{}' reads camera '{}' of '{}', which takes no pictures: the scenario's 'cameras' leaves it out",
                  controller, owner.model->devices[static_cast<std::size_t>(device)].name, owner.name));
}

void WorldRemarks::observe(std::int64_t tick, const World& world, const Observation& seen, const Command& command,
                           std::vector<msg::Event>& events) {
  for (std::string& text : std::exchange(idle_cameras_, {})) add(tick, Severity::warning, std::move(text), events);
  if (!is_calm(seen)) {
    check_limits(tick, seen, events);
    check_speeds(tick, seen, events);
  }
  check_drives(tick, seen, command, events);
  check_actuators(tick, seen, events);
  if (tick == 0) return;
  check_solver(tick, world, events);
  check_unsolved(tick, world.unsolved(), events);
  check_residual(tick, world.residual(), events);
  check_missed(tick, world.residual(), events);
  for (const std::string& event : world.events())
    add(tick, Severity::note, fmt::format("{} in the step after tick {}", event, tick - 1), events);
}

void WorldRemarks::add(std::int64_t tick, Severity severity, std::string text, std::vector<msg::Event>& events) const {
  msg::Event& event = events.emplace_back();
  event.stamp = msg::Time::from_ns(nanoseconds_of(tick, scenario_.time_step));
  event.tick = tick;
  event.severity = to_string(severity);
  event.source = "world";
  event.text = std::move(text);
}

void WorldRemarks::check_solver(std::int64_t tick, const World& world, std::vector<msg::Event>& events) {
  if (world.solver_message().empty()) return;
  std::set<std::string> touching;
  for (const LinkPair& pair : world.touching())
    for (const int body : {pair.body, pair.other_body}) touching.insert("'" + scenario_.bodies[body].name + "'");
  add(tick, std::exchange(solver_failed_, true) ? Severity::note : Severity::warning,
      fmt::format(
          "the exact solver found no solution in the step after tick {}, when {} touched; the quick solver made "
          "the step with 1000 iterations ({})",
          tick - 1, fmt::join(touching, ", "), world.solver_message()),
      events);
}

void WorldRemarks::check_unsolved(std::int64_t tick, const Unsolved& unsolved, std::vector<msg::Event>& events) {
  constexpr double most = 1e-3;  // of the weight
  if (unsolved.share >= std::max(most, 2.0 * unsolved_)) {
    add(tick, std::exchange(unsolved_, unsolved.share) == 0.0 ? Severity::warning : Severity::note,
        fmt::format(
            "the direct solver leaves a contact force wrong by {:.2g} % of the weight in the step after tick {}",
            100.0 * unsolved.share, tick - 1),
        events);
  }
  if (unsolved.contacts == 0) return;
  constexpr double most_at_contacts = 0.15;  // of the lighter body's weight
  if (unsolved.contact_share >= std::max(most_at_contacts, 2.0 * missing_at_contacts_)) {
    const bool is_first = std::exchange(missing_at_contacts_, unsolved.contact_share) == 0.0;
    add(tick, is_first ? Severity::warning : Severity::note,
        fmt::format(
            "the quick solver leaves the force at a contact wrong by {:.2g} % of the lighter body's weight in the "
            "step after tick {}",
            100.0 * unsolved.contact_share, tick - 1),
        events);
  }
  if (std::exchange(crowded_, true)) return;
  add(tick, Severity::warning,
      fmt::format(
          "bodies that touch at {} points, more than {}, are left to the quick solver in the step after tick {}",
          unsolved.contacts, unsolved.most_contacts, tick - 1),
      events);
}

/// Reported when it is twice as large as before, and at the 10th, 100th, ... step, so that a lasting one is seen.
void WorldRemarks::check_residual(std::int64_t tick, const Residual& residual, std::vector<msg::Event>& events) {
  constexpr double most = 0.15;  // of the body's weight
  if (residual.joint.body < 0 || residual.share < most) return;
  const bool lasts = ++unconverged_steps_ == next_unconverged_report_;
  if (lasts) next_unconverged_report_ *= 10;
  if (residual.share < 2.0 * residual_ && !lasts) return;
  const Severity severity = residual_ == 0.0 ? Severity::warning : Severity::note;
  residual_ = std::max(residual_, residual.share);
  const ScenarioBody& body = scenario_.bodies[static_cast<std::size_t>(residual.joint.body)];
  const std::string& joint = body.model->links[static_cast<std::size_t>(residual.joint.link)].joint.name;
  add(tick, severity,
      fmt::format("the solver's {} iterations leave the forces at joint '{}' of '{}' wrong by {:.0f} % of the body's "
                  "weight in the step after tick {}{}; 'method: direct' of the solver computes them",
                  residual.iterations, joint, body.name, 100.0 * residual.share, tick - 1,
                  unconverged_steps_ > 1 ? fmt::format(", and in {} before", unconverged_steps_ - 1) : ""),
      events);
}

/// A light link between heavy ones misses no large force, but its drive's velocity.
void WorldRemarks::check_missed(std::int64_t tick, const Residual& residual, std::vector<msg::Event>& events) {
  constexpr double most = 0.5;  // [rad/s] or [m/s]
  if (residual.velocity < std::max(most, 2.0 * missed_)) return;
  const bool is_first = std::exchange(missed_, residual.velocity) == 0.0;
  const ScenarioBody& body = scenario_.bodies[static_cast<std::size_t>(residual.missed.body)];
  const Joint& joint = body.model->links[static_cast<std::size_t>(residual.missed.link)].joint;
  add(tick, is_first ? Severity::warning : Severity::note,
      fmt::format("the solver's {} iterations leave joint '{}' of '{}' {:.2g} {} off its drive's velocity in the step "
                  "after tick {}; 'method: direct' of the solver reaches it",
                  residual.iterations, joint.name, body.name, residual.velocity,
                  is_linear(joint.type) ? "m/s" : "rad/s", tick - 1),
      events);
}

void WorldRemarks::check_drives(std::int64_t tick, const Observation& seen, const Command& command,
                                std::vector<msg::Event>& events) {
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const ScenarioBody& body = scenario_.bodies[i];
    if (body.kinematic) continue;
    for (std::size_t id = 0; id < joints_[i].size(); ++id) {
      const JointCommand& wanted = command.bodies[i].joints[id];
      if (wanted.drive & (drive_displacement | drive_velocity))
        check_drive(tick, i, joint_of(i, id), seen.bodies[i].joints[id], wanted, joints_[i][id], events);
    }
  }
}

/// The first of a body is a warning, and so a remark of the run; those of other joints are notes.
void WorldRemarks::check_actuators(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events) {
  constexpr double nearly = 1.0 - 1e-9, about = 1.0 - 1e-6;  // of the wanted effort; of the limit of a hot drive
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const ScenarioBody& body = scenario_.bodies[i];
    for (std::size_t id = 0; id < seen.bodies[i].actuators.size(); ++id) {
      const ActuatorReading& now = seen.bodies[i].actuators[id];
      const bool is_limited = now.wanted > 0.0 ? now.effort < nearly * now.wanted : now.effort > nearly * now.wanted;
      const bool is_hot = std::abs(now.effort) >= about * now.thermal_limit;
      JointRemarks& known = joints_[i][id];
      if ((!is_limited && !is_hot) || std::exchange(is_hot ? known.hot : known.limited, true)) continue;
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      const bool slides = is_linear(joint.type);
      const char* const unit = slides ? "N" : "N·m";
      const std::string how =
          is_hot ? fmt::format("is hot and exerts its continuous effort, {:.4g} {}", std::abs(now.effort), unit)
                 : fmt::format("limited {:.4g} {} to {:.4g}", now.wanted, unit, now.effort);
      std::vector<bool>& told = is_hot ? hot_ : limited_;
      add(tick, told[i] ? Severity::note : Severity::warning,
          fmt::format("the actuator of joint '{}' of '{}' {}, at {:.3g} {}", joint.name, body.name, how,
                      seen.bodies[i].joints[id].dq, slides ? "m/s" : "rad/s"),
          events);
      told[i] = true;
    }
  }
}

/// The effort is that of the step before the tick.
void WorldRemarks::check_drive(std::int64_t tick, std::size_t index, const Joint& joint, const JointReading& now,
                               const JointCommand& wanted, JointRemarks& known, std::vector<msg::Event>& events) {
  constexpr double slack = 1e-4, nearly = 1.0 - 1e-6;  // [rad] or [m]; of the effort limit
  const ScenarioBody& body = scenario_.bodies[index];
  const bool slides = is_linear(joint.type);
  const auto report = [&](bool& reported, Severity severity, const std::string& text) {
    if (std::exchange(reported, true)) return;
    add(tick, severity, fmt::format("joint '{}' of '{}' {}", joint.name, body.name, text), events);
  };
  const bool is_full =
      tick > 0 && body.drive_limits && std::isfinite(joint.effort) && std::abs(now.u) >= nearly * joint.effort;
  if (is_full)
    report(known.at_full_effort, Severity::note,
           fmt::format("was driven with its largest effort, {:.4g} {}", joint.effort, slides ? "N" : "N·m"));
  if (wanted.drive & drive_displacement) {
    const double missing = wanted.q - now.q, far = slides ? 0.005 : 0.05;  // [m], [rad]
    const double slow = slides ? 0.001 : 0.01;                             // [m/s], [rad/s]
    const bool goes_away = missing * now.dq < 0.0 && std::abs(now.dq) > slow && missing * now.ddq < 0.0;  // no braking
    if (!is_full || std::abs(missing) < far || !goes_away) return;
    report(known.sinks, sinking_[index] ? Severity::note : Severity::warning,
           fmt::format("moves away from its command, {:.3g} {} so far: its effort limit of {:.4g} {} is too small",
                       std::abs(missing), slides ? "m" : "rad", joint.effort, slides ? "N" : "N·m"));
    sinking_[index] = true;
    return;
  }
  const char* const unit = slides ? "m/s" : "rad/s";
  if (std::abs(wanted.dq) > joint.velocity)
    report(known.too_fast, Severity::warning,
           fmt::format(
               "is driven at {:.4g} {}, beyond its velocity limit of {:.4g} {}, which a velocity drive doesn't obey",
               wanted.dq, unit, joint.velocity, unit));
  const bool has_stops = body.joint_limits.value_or(true) && joint.type != JointType::track;
  const bool at_upper = now.q >= joint.upper - slack && wanted.dq > 0.0;
  const bool at_lower = now.q <= joint.lower + slack && wanted.dq < 0.0;
  if (has_stops && (at_upper || at_lower))
    report(known.blocked, Severity::note,
           fmt::format("is at its limit, {:.4g} {}, and its velocity drive is commanded beyond it",
                       at_upper ? joint.upper : joint.lower, slides ? "m" : "rad"));
}

/// True in nearly all ticks: each joint is, and was, within its limits, and none is too fast.
bool WorldRemarks::is_calm(const Observation& seen) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    for (std::size_t id = 0; id < joints_[i].size(); ++id) {
      const JointRemarks& known = joints_[i][id];
      const JointReading& now = seen.bodies[i].joints[id];
      const bool is_within = now.q >= known.lower && now.q <= known.upper && known.last_excess == 0.0;
      if (!is_within || !(std::abs(now.dq) < most_speed)) return false;
    }
  }
  return true;
}

/// An excess is reported when it no longer grows, so that the event states how far the joint went, or when it is large.
void WorldRemarks::check_limits(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events) {
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const ScenarioBody& body = scenario_.bodies[i];
    for (std::size_t id = 0; id < joints_[i].size(); ++id) {
      JointRemarks& known = joints_[i][id];
      const double q = seen.bodies[i].joints[id].q;
      const double excess = std::abs(q - std::clamp(q, known.lower, known.upper));
      const double last = std::exchange(known.last_excess, excess);
      const double far = std::max(excess, last);
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      if (joint.type == JointType::track) continue;
      const bool slides = joint.type == JointType::prismatic;
      const double least = slides ? 0.005 : 0.05;  // [m], [rad]; a stop gives way for some steps
      const bool grows = tick > 0 && excess >= last;
      if (far < std::max((grows ? 10.0 : 1.0) * least, 2.0 * known.excess)) continue;
      const Severity severity = known.excess == 0.0 ? Severity::warning : Severity::note;
      known.excess = far;
      add(tick, severity,
          fmt::format("joint '{}' of '{}' {} {:.3g} {} beyond its limits, {:.4g} to {:.4g}", joint.name, body.name,
                      tick == 0 ? "begins" : "went", far, slides ? "m" : "rad", joint.lower, joint.upper),
          events);
    }
  }
}

void WorldRemarks::check_speeds(std::int64_t tick, const Observation& seen, std::vector<msg::Event>& events) {
  constexpr double further = 10.0;  // factor between two reports
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const ScenarioBody& body = scenario_.bodies[i];
    for (std::size_t id = 0; id < joints_[i].size(); ++id) {
      const double speed = std::abs(seen.bodies[i].joints[id].dq);
      JointRemarks& known = joints_[i][id];
      if (speed < std::max(most_speed, further * known.speed)) continue;
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      add(tick, std::exchange(known.speed, speed) == 0.0 ? Severity::warning : Severity::note,
          fmt::format("joint '{}' of '{}' moves at {:.3g} {}", joint.name, body.name, speed,
                      joint.type == JointType::prismatic || joint.type == JointType::track ? "m/s" : "rad/s"),
          events);
    }
  }
}

}  // namespace rehearse
