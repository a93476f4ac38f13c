// The cost of a step of SR1 standing in Rehearse relative to MuJoCo's, in one process: the model of both is made from
// the same URDF. MuJoCo solves a softer problem by Newton's method, with its defaults and the same time step.

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "pairs.h"
#include "sr1_run.h"
#include "standing.h"

namespace rehearse {
namespace {

constexpr int slice = 50;     // steps measured at a time
constexpr int settled = 500;  // steps before the first measurement

std::string vector_text(const Eigen::Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string pose_text(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("pos='{}' quat='{:.17g} {:.17g} {:.17g} {:.17g}'", vector_text(pose.translation()), q.w(), q.x(),
                     q.y(), q.z());
}

/// Robots touch the ground, and not themselves.
std::string geom_text(const Shape& shape, bool is_ground) {
  const auto size = [](const auto& geometry) -> std::string {
    using Geometry = std::decay_t<decltype(geometry)>;
    if constexpr (std::is_same_v<Geometry, Box>)
      return fmt::format("type='box' size='{}'", vector_text(0.5 * geometry.size));
    else if constexpr (std::is_same_v<Geometry, Sphere>)
      return fmt::format("type='sphere' size='{:.17g}'", geometry.radius);
    else if constexpr (std::is_same_v<Geometry, Mesh>)
      std::abort();  // neither SR1 nor its floor has one
    else
      return fmt::format("type='{}' size='{:.17g} {:.17g}'",
                         std::is_same_v<Geometry, Cylinder> ? "cylinder" : "capsule", geometry.radius,
                         0.5 * geometry.length);
  };
  return fmt::format("<geom {} {} contype='{}' conaffinity='{}'/>", std::visit(size, shape.geometry),
                     pose_text(shape.pose), is_ground ? 2 : 1, is_ground ? 1 : 2);
}

std::string joint_text(const Joint& joint) {
  if (joint.type == JointType::free) return "<freejoint/>";
  if (joint.id < 0) return "";
  return fmt::format(
      "<joint name='j{}' type='{}' axis='{}' limited='{}' range='{:.17g} {:.17g}' damping='{:.17g}' "
      "frictionloss='{:.17g}' armature='{:.17g}'/>",
      joint.id, is_linear(joint.type) ? "slide" : "hinge", vector_text(joint.axis), joint.lower > -unlimited,
      joint.lower > -unlimited ? joint.lower : 0.0, joint.upper < unlimited ? joint.upper : 0.0, joint.damping,
      joint.friction, joint.armature);
}

/// The elements of a link and of all beyond it.
std::string link_text(const Model& model, int index, const Eigen::Isometry3d& pose) {
  const Link& link = model.links[static_cast<std::size_t>(index)];
  const Eigen::Matrix3d& m = link.inertial.inertia;
  std::string text = fmt::format("<body name='l{}' {}>{}", index, pose_text(pose), joint_text(link.joint));
  if (link.inertial.mass > 0.0)
    text += fmt::format(
        "<inertial mass='{:.17g}' pos='{}' fullinertia='{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}'/>",
        link.inertial.mass, vector_text(link.inertial.center), m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2));
  text += fmt::format("<site name='s{}'/>", index);
  for (const Shape& shape : link.collisions) text += geom_text(shape, false);
  for (std::size_t child = 0; child < model.links.size(); ++child)
    if (model.links[child].parent == index)
      text += link_text(model, static_cast<int>(child), model.links[child].joint.origin);
  return text + "</body>";
}

/// What Rehearse measures in each step, too.
std::string sensors_text(const Model& model) {
  std::string text;
  for (const Device& device : model.devices) {
    const auto add = [&](const char* element) { text += fmt::format("<{} site='s{}'/>", element, device.link); };
    if (std::holds_alternative<ForceSensor>(device.kind)) add("force"), add("torque");
    if (std::holds_alternative<Gyro>(device.kind)) add("gyro");
    if (std::holds_alternative<Accelerometer>(device.kind)) add("accelerometer");
  }
  return text;
}

std::string mjcf_text() {
  const Scenario& scenario = Sr1Run::instance().scenario();
  std::string text = fmt::format(
      "<mujoco><compiler angle='radian' boundmass='1e-6' boundinertia='1e-9'/><option timestep='{:.17g}' gravity='{}'/>"
      "<worldbody>",
      scenario.time_step, vector_text(scenario.gravity));
  std::string sensors;
  for (const WorldBody& body : Sr1Run::instance().bodies()) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = body.rotation.toRotationMatrix();
    pose.translation() = body.position;
    if (!body.fixed) {
      text += link_text(*body.model, 0, pose);
      sensors += sensors_text(*body.model);
      continue;
    }
    for (Shape shape : body.model->links[0].collisions) {
      shape.pose = pose * shape.pose;
      text += geom_text(shape, true);
    }
  }
  return text + "</worldbody><sensor>" + sensors + "</sensor></mujoco>";
}

/// The robot of Standing, held by the same torques.
class MujocoStanding {
 public:
  MujocoStanding() : model_(compiled(), mj_deleteModel), data_(mj_makeData(model_.get()), mj_deleteData) {
    const WorldBody robot = Sr1Run::instance().bodies().at(1);
    for (std::size_t id = 0; id < robot.joints.size(); ++id) {
      const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, fmt::format("j{}", id).c_str());
      if (joint < 0) std::abort();
      joints_.push_back({model_->jnt_qposadr[joint], model_->jnt_dofadr[joint], robot.joints[id]});
      data_->qpos[joints_.back().position] = robot.joints[id];
    }
    steps(settled);
  }

  void steps(int count) {
    for (int i = 0; i < count; ++i) {
      for (std::size_t id = 0; id < joints_.size(); ++id) {
        const Place& joint = joints_[id];
        data_->qfrc_applied[joint.rate] =
            holding_torque(id, joint.beginning, data_->qpos[joint.position], data_->qvel[joint.rate]);
      }
      mj_step(model_.get(), data_.get());
    }
  }
  double height() const { return data_->qpos[2]; }  // [m]
  int contacts() const { return data_->ncon; }

 private:
  struct Place {
    int position, rate;  // indices of the joint in qpos and qvel
    double beginning;    // [rad]
  };

  static mjModel* compiled() {
    const std::string text = mjcf_text();
    const std::unique_ptr<mjVFS> files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "sr1.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[0], text.data(), text.size());
    char error[1000] = "";
    mjModel* const model = mj_loadXML("sr1.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model) return model;
    std::fprintf(stderr, "%s\n", error);
    std::exit(1);
  }

  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_;
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_;
  std::vector<Place> joints_;
};

/// Work: a step of SR1 standing with the direct solver. Base: MuJoCo's.
void direct_step_over_mujoco(benchmark::State& state) {
  Standing ours(SolverSettings::Method::direct, Standing::Held::by_torque);
  MujocoStanding mujoco;
  Pairs pairs;
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { ours.steps(slice); }, [&] { mujoco.steps(slice); }));
  if (ours.height() < 0.7 || mujoco.height() < 0.7 || mujoco.contacts() != 8) state.SkipWithError("SR1 fell");
  pairs.report(state, slice, slice);
}
BENCHMARK(direct_step_over_mujoco)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
