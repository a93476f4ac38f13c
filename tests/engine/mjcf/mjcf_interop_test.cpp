// Models as MuJoCo compiles them: masses, inertias, frames, axes, ranges and keyframes of our own models, and of public
// ones in a folder that is named at configure time: cmake -DREHEARSE_MUJOCO_MODELS=DIR. Those files aren't part of this
// repository, so without it that test is skipped. REHEARSE_MODEL_TABLE in the environment prints a line per model.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <rehearse/body.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <set>

#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double exact = 1e-9;
constexpr double axes_of_inertia = 2e-6;   // MuJoCo's solver of eigenvectors ends at turns below 1.4e-6 rad
constexpr double single_precision = 1e-5;  // MuJoCo 2.2.2 has the vertices of meshes in floats

using MujocoModel = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using MujocoData = std::unique_ptr<mjData, void (*)(mjData*)>;

Eigen::Vector3d vector(const mjtNum* v) { return {v[0], v[1], v[2]}; }
Eigen::Quaterniond quaternion(const mjtNum* q) { return {q[0], q[1], q[2], q[3]}; }

/// The largest differences of a model, each relative to 1 or, of masses and inertias, to the largest number compared.
struct Differences {
  double masses = 0.0, axes = 0.0, meshes = 0.0, frames = 0.0, joints = 0.0;
  int bodies = 0, numbered = 0;
  std::string first;

  void take(double& worst, double difference, double limit, const std::string& what) {
    if (difference > limit && first.empty()) first = fmt::format("{}: {}", what, difference);
    worst = std::max(worst, difference);
  }
};

class Compared {
 public:
  Compared(const Model& ours, const mjModel& theirs)
      : ours_(ours), theirs_(theirs), data_(mj_makeData(&theirs), mj_deleteData) {}

  Differences run() {
    std::vector<double> q;
    for (const int link : ours_.joints) q.push_back(ours_.links[static_cast<std::size_t>(link)].joint.start);
    mj_resetData(&theirs_, data_.get());
    mj_kinematics(&theirs_, data_.get());
    compare_masses();
    compare_joints();
    compare_frames(q, ours_.links[0].joint.origin, "at qpos0");
    for (const Posture& posture : ours_.postures) {
      const int key = mj_name2id(&theirs_, mjOBJ_KEY, posture.name.c_str());
      if (key < 0) continue;
      mj_resetDataKeyframe(&theirs_, data_.get(), key);
      mj_kinematics(&theirs_, data_.get());
      compare_frames(posture.q, posture.root.value_or(ours_.links[0].joint.origin), "in keyframe " + posture.name);
    }
    return found_;
  }

 private:
  std::string name(int type, int id) const {
    const char* text = mj_id2name(&theirs_, type, id);
    return text ? text : "";
  }
  /// The anchor of the body's last joint, where our link has its frame.
  Eigen::Vector3d anchor(int body) const {
    const int count = theirs_.body_jntnum[body];
    return count == 0 ? Eigen::Vector3d::Zero() : vector(theirs_.jnt_pos + 3 * (theirs_.body_jntadr[body] + count - 1));
  }
  template <class Use>
  void each_body(const Use& use) {
    for (int body = 1; body < theirs_.nbody; ++body)
      if (const int link = ours_.find_link(name(mjOBJ_BODY, body)); link >= 0)
        use(body, static_cast<std::size_t>(link));
  }

  void compare_masses() {
    each_body([&](int body, std::size_t link) {
      ++found_.bodies;
      const Inertial& inertial = ours_.links[link].inertial;
      const Eigen::Matrix3d turn = quaternion(theirs_.body_iquat + 4 * body).toRotationMatrix();
      const Eigen::Matrix3d inertia = turn * vector(theirs_.body_inertia + 3 * body).asDiagonal() * turn.transpose();
      bool has_mesh = false;
      for (int geom = theirs_.body_geomadr[body];
           geom >= 0 && geom < theirs_.body_geomadr[body] + theirs_.body_geomnum[body]; ++geom)
        has_mesh = has_mesh || theirs_.geom_type[geom] == mjGEOM_MESH;
      double& worst = has_mesh ? found_.meshes : found_.masses;
      const double limit = has_mesh ? single_precision : exact;
      const double mass = theirs_.body_mass[body];
      found_.take(worst, std::abs(inertial.mass - mass) / std::max(mass, 1e-3), limit,
                  "mass of " + name(mjOBJ_BODY, body));
      if (mass == 0.0) return;
      found_.take(worst, (inertial.center + anchor(body) - vector(theirs_.body_ipos + 3 * body)).norm(), limit,
                  "centre of " + name(mjOBJ_BODY, body));
      const double largest = std::max(inertia.cwiseAbs().maxCoeff(), 1e-9);
      const auto moments = [](const Eigen::Matrix3d& matrix) {
        return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
      };
      found_.take(worst, (moments(inertial.inertia) - moments(inertia)).cwiseAbs().maxCoeff() / largest, limit,
                  "moments of " + name(mjOBJ_BODY, body));
      found_.take(found_.axes, (inertial.inertia - inertia).cwiseAbs().maxCoeff() / largest,
                  std::max(limit, axes_of_inertia), "inertia of " + name(mjOBJ_BODY, body));
    });
  }

  void compare_joints() {
    for (int id = 0; id < theirs_.njnt; ++id) {
      if (theirs_.jnt_type[id] != mjJNT_HINGE && theirs_.jnt_type[id] != mjJNT_SLIDE) continue;
      const std::string joint_name = name(mjOBJ_JOINT, id);
      const int link = ours_.find_joint(joint_name);
      if (joint_name.empty() || link < 0) continue;
      ++found_.numbered;
      const Joint& joint = ours_.links[static_cast<std::size_t>(link)].joint;
      const int dof = theirs_.jnt_dofadr[id];
      const auto same = [&](double a, double b, const char* what) {
        found_.take(found_.joints, std::abs(a - b) / std::max(1.0, std::abs(b)), exact, what + (" of " + joint_name));
      };
      same((joint.axis - vector(theirs_.jnt_axis + 3 * id)).norm(), 0.0, "axis");
      same(joint.start, theirs_.qpos0[theirs_.jnt_qposadr[id]], "ref");
      same(joint.damping, theirs_.dof_damping[dof], "damping");
      same(joint.armature, theirs_.dof_armature[dof], "armature");
      same(joint.friction, theirs_.dof_frictionloss[dof], "frictionloss");
      same(joint.spring_stiffness, theirs_.jnt_stiffness[id], "stiffness");
      if (joint.spring_stiffness > 0.0)
        same(joint.spring_reference, theirs_.qpos_spring[theirs_.jnt_qposadr[id]], "springref");
      if (!theirs_.jnt_limited[id]) continue;
      same(joint.lower, theirs_.jnt_range[2 * id], "lower limit");
      same(joint.upper, theirs_.jnt_range[2 * id + 1], "upper limit");
    }
  }

  void compare_frames(const std::vector<double>& q, const Eigen::Isometry3d& root, const std::string& when) {
    const auto poses = forward_kinematics(ours_, root, q);
    each_body([&](int body, std::size_t link) {
      const Eigen::Isometry3d& pose = poses[link];
      const Eigen::Matrix3d turn = quaternion(data_->xquat + 4 * body).toRotationMatrix();
      const std::string where = "frame of " + name(mjOBJ_BODY, body) + " " + when;
      found_.take(found_.frames, (pose * Eigen::Vector3d(-anchor(body)) - vector(data_->xpos + 3 * body)).norm(), exact,
                  where);
      found_.take(found_.frames, (pose.linear() - turn).cwiseAbs().maxCoeff(), exact, where);
    });
  }

  const Model& ours_;
  const mjModel& theirs_;
  MujocoData data_;
  Differences found_;
};

MujocoModel compiled(const fs::path& file, std::string& reason) {
  char text[1000] = "";
  MujocoModel model(mj_loadXML(file.c_str(), nullptr, text, sizeof text), mj_deleteModel);
  reason = text;
  return model;
}

void expect_same(const fs::path& file) {
  std::string reason;
  const MujocoModel theirs = compiled(file, reason);
  ASSERT_TRUE(theirs) << file << ": " << reason;
  const Result<Model> ours = load_model(file);
  ASSERT_TRUE(ours) << to_string(ours.errors());
  const Differences found = Compared(*ours, *theirs).run();
  EXPECT_EQ(found.first, "") << file;
  EXPECT_EQ(found.bodies, theirs->nbody - 1) << "each body is compared";
}

TEST(MjcfInMujoco, TheQuadrupedIsTheSame) { expect_same(FIXTURES_DIR "/models/quadruped.xml"); }

/// Forms that the quadruped lacks: orientations, references, several joints in a body, masses from all geoms, frames.
constexpr const char* forms = R"(<mujoco model="forms">
  <compiler angle="degree" eulerseq="zYx" autolimits="true" boundmass="0.01" boundinertia="1e-5"/>
  <default><geom density="700"/><joint damping="0.3" armature="0.01"/>
    <default class="slow"><joint damping="3" frictionloss="0.2"/><geom density="500" friction="0.6"/></default></default>
  <asset><mesh name="wedge" vertex="0 0 0  0.1 0 0  0 0.2 0  0 0 0.3" scale="1 2 1"/></asset>
  <worldbody>
    <body name="cart" pos="0.1 0.2 0.3" euler="10 20 30">
      <joint name="x" type="slide" axis="1 0 0" range="-1 2" ref="0.2"/>
      <joint name="z" type="slide" axis="0 0 1" pos="0.1 0 0"/>
      <joint name="turn" axis="1 2 3" pos="0.05 -0.02 0.1" ref="30" range="-90 120" stiffness="2" springref="15"/>
      <geom type="box" size="0.1 0.2 0.3" pos="0.01 0.02 0.03" axisangle="1 1 0 40"/>
      <geom type="ellipsoid" size="0.1 0.15 0.2" xyaxes="0 1 0 -1 0 0.2"/>
      <body name="mast" pos="0 0 0.5" zaxis="1 0 1" childclass="slow">
        <joint name="lean" axis="0 1 0" pos="0 0 -0.1"/>
        <geom type="capsule" fromto="0 0 0 0.1 0.2 0.4" size="0.05" mass="0.7"/>
        <geom type="cylinder" size="0.04 0.2" quat="1 2 3 4" group="3"/>
        <body name="tip" pos="0 0 0.4"><geom size="0.03"/><geom type="mesh" mesh="wedge" pos="0 0.1 0" mass="0.001"/></body>
        <body name="arm" pos="0.2 0 0" euler="0 90 0">
          <joint name="reach" type="slide" axis="0 0 2" range="0 0.4"/>
          <inertial pos="0.01 0 0.02" mass="0.4" fullinertia="0.02 0.03 0.025 0.001 0.002 -0.003"/>
          <geom type="box" fromto="0 0 0 0 0.1 0.3" size="0.02"/>
        </body>
      </body>
    </body>
    <body name="ball" pos="3 0 1" quat="0.5 0.5 0.5 0.5"><freejoint name="fly"/><geom size="0.1"/></body>
  </worldbody>
  <keyframe><key name="bent" qpos="0.5 -0.1 1.1 0.4 0.3  3 0 1 0.5 0.5 0.5 0.5"/></keyframe>
</mujoco>)";

TEST(MjcfInMujoco, AllFormsAreTheSame) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "forms.xml") << forms;
  expect_same(folder.path() / "forms.xml");
}

TEST(MjcfInMujoco, PublicModelsAreTheSame) {
  const std::string checkout = MUJOCO_MODELS;
  if (checkout.empty()) GTEST_SKIP() << "there is no folder of MuJoCo models: -DREHEARSE_MUJOCO_MODELS=DIR";
  const bool prints = std::getenv("REHEARSE_MODEL_TABLE") != nullptr;
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(checkout))
    if (entry.path().extension() == ".xml") files.insert(entry.path());
  int same = 0, refused = 0, unread = 0;
  for (const fs::path& file : files) {
    std::string reason;
    const MujocoModel theirs = compiled(file, reason);
    if (!theirs || theirs->nbody < 2) continue;  // a part that other files include, or a newer form
    const Result<Model> plain = load_model(file);
    const Result<Model> ours = plain ? plain : load_model(file, {.allow_unsupported = true});
    refused += plain ? 0 : 1;
    if (!ours) {
      ++unread;
      if (prints) std::cout << file << ": " << to_string(ours.errors()[0]) << "\n";
      continue;
    }
    const Differences found = Compared(*ours, *theirs).run();
    EXPECT_EQ(found.first, "") << file;
    same += found.first.empty() ? 1 : 0;
    if (prints)
      std::cout << fmt::format(
          "{}: {} bodies, {} joints, {}; masses {:.1g}, with meshes {:.1g}, frames {:.1g}, joints {:.1g}\n",
          fs::relative(file, checkout).string(), found.bodies, found.numbered,
          plain ? "whole" : to_string(plain.errors()[0]), found.masses, found.meshes, found.frames, found.joints);
  }
  std::cout << fmt::format("{} models are the same, {} of all only without unsupported parts, {} aren't read\n", same,
                           refused, unread);
  EXPECT_GT(same, 0);
}

}  // namespace
}  // namespace rehearse
