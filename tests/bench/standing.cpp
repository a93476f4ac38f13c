#include "standing.h"

#include <fmt/format.h>
#include <rehearse/body.h>

#include <cstdlib>
#include <string>
#include <utility>

#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr int settled = 500;              // steps before the first measurement
constexpr std::size_t first_finger = 29;  // index of a joint

/// SR1 with a finger of seven joints at each wrist, so that it has 43 joints.
std::shared_ptr<const Model> sr1_with_fingers(const Model& sr1) {
  std::string text = sr1.source_text, fingers;
  for (const char* side : {"RARM", "LARM"}) {
    std::string parent = fmt::format("{}_WRIST_R", side);
    for (int i = 0; i < 7; ++i) {
      const std::string name = fmt::format("{}_FINGER{}", side, i);
      fingers += fmt::format(
          R"(<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{0}"/><origin xyz="0 0 -0.03"/>
          <axis xyz="{2}"/></joint><link name="{0}"><inertial><origin xyz="0 0 -0.015"/><mass value="0.05"/>
          <inertia ixx="2e-5" ixy="0" ixz="0" iyy="2e-5" iyz="0" izz="1e-5"/></inertial></link>)",
          name, parent, i % 2 == 0 ? "1 0 0" : "0 1 0");
      parent = name;
    }
  }
  text.insert(text.rfind("</robot>"), fingers);
  return std::make_shared<const Model>(must(parse_model(text, sr1.source_file)));
}

}  // namespace

double holding_torque(std::size_t joint, double beginning, double q, double dq) {
  const bool is_finger = joint >= first_finger;
  const double p_gain = is_finger ? 5.0 : 5000.0, d_gain = is_finger ? 0.02 : 100.0;  // [N·m/rad], [N·m·s/rad]
  return p_gain * (beginning - q) - d_gain * dq;
}

Standing::Standing(SolverSettings::Method method, Held held) : held_(held) {
  SolverSettings solver = Sr1Run::instance().scenario().solver;
  solver.method = method;
  std::vector<WorldBody> bodies = Sr1Run::instance().bodies();
  if (held == Held::by_torque_with_fingers) {
    bodies[1].model = sr1_with_fingers(*bodies[1].model);
    bodies[1].joints.resize(bodies[1].model->joints.size());
  }
  world_ = Sr1Run::instance().make_world(solver, std::move(bodies));
  for (const BodyObservation& seen : world_->sense().bodies) {
    BodyCommand& body = command_.bodies.emplace_back();
    body.joints.resize(seen.joints.size());
    body.external.resize(seen.links.size());
    body.devices.resize(seen.devices.size());
    if (seen.joints.size() > joints_.size()) {
      joints_ = seen.joints;
      robot_ = command_.bodies.size() - 1;
    }
  }
  steps(settled);
}

void Standing::steps(int count) {
  for (int i = 0; i < count; ++i) {
    hold();
    world_->actuate(command_);
    if (!world_->step()) std::abort();
  }
}

void Standing::hold() {
  const std::vector<JointReading>& now = world_->sense().bodies[robot_].joints;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const double torque = holding_torque(i, joints_[i].q, now[i].q, now[i].dq);
    command_.bodies[robot_].joints[i] = held_ == Held::by_limited_drive ? JointCommand{drive_displacement, joints_[i].q}
                                                                        : JointCommand{drive_effort, 0.0, 0.0, torque};
  }
}

}  // namespace rehearse
