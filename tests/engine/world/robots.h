// Small robots made in a few lines, and functions to run them, for tests of the world.
#pragma once

#include <rehearse/world.h>

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

inline constexpr double standard_gravity = 9.80665;  // [m/s²]
inline constexpr double pi = std::numbers::pi;
inline constexpr double wheel_inertia = 0.5;  // of robots that consist of a wheel, about its axle [kg·m²]

/// A body of that mass [kg] and diagonal inertia [kg·m²] about its centre [m].
inline Inertial inertial(double mass, const Eigen::Vector3d& diagonal,
                         const Eigen::Vector3d& center = Eigen::Vector3d::Zero()) {
  return {mass, center, diagonal.asDiagonal()};
}

inline Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

/// A model, link by link. Links come parents first, joints get their ids in the order in which they are added.
class RobotBuilder {
 public:
  explicit RobotBuilder(JointType root, const Inertial& inertial = {}) {
    model_.name = "Robot";
    add_link("ROOT", -1, root, inertial);
  }

  /// Adds a link to a parent by index; returns the joint to be described further.
  Joint& add(const std::string& name, int parent, JointType type, const Eigen::Vector3d& axis, const Inertial& inertial,
             const Eigen::Isometry3d& origin = Eigen::Isometry3d::Identity()) {
    Joint& joint = add_link(name, parent, type, inertial);
    joint.origin = origin;
    joint.axis = axis;
    if (has_id(type)) {
      joint.id = static_cast<int>(model_.joints.size());
      model_.joints.push_back(static_cast<int>(model_.links.size()) - 1);
    }
    return joint;
  }

  void add_device(const std::string& name, int link, const DeviceKind& kind,
                  const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    model_.devices.push_back({name, -1, link, pose, kind, 0});
  }

  void add_loop(const LoopJoint& loop) { model_.loops.push_back(loop); }

  Shape& add_collision(int link, const Geometry& geometry) {
    model_.links[link].collisions.push_back({"", geometry, Eigen::Isometry3d::Identity(), {}, {}});
    return model_.links[link].collisions.back();
  }

  std::shared_ptr<const Model> build() const { return std::make_shared<const Model>(model_); }

 private:
  Joint& add_link(const std::string& name, int parent, JointType type, const Inertial& inertial) {
    Link& link = model_.links.emplace_back();
    link.name = name;
    link.parent = parent;
    link.inertial = inertial;
    link.joint.name = parent < 0 ? "" : name;
    link.joint.type = type;
    return link.joint;
  }

  Model model_;
};

/// A body named after its model, joints at zero.
inline WorldBody body_of(std::shared_ptr<const Model> model,
                         const Eigen::Vector3d& position = Eigen::Vector3d::Zero()) {
  WorldBody body;
  body.name = model->name;
  body.joints.assign(model->joints.size(), 0.0);
  body.model = std::move(model);
  body.position = position;
  return body;
}

/// An arm of six links of 1 kg, stretched out sideways, whose last link weighs 20 kg.
inline std::shared_ptr<const Model> loaded_arm() {
  RobotBuilder robot(JointType::fixed);
  for (int i = 0; i < 6; ++i) {
    const double mass = i == 5 ? 20.0 : 1.0;
    robot.add(
        "LINK" + std::to_string(i), i, JointType::revolute, i % 2 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY(),
        inertial(mass, Eigen::Vector3d::Constant(0.01 * mass), {0.1, 0.0, 0.0}), at(i == 0 ? 0.0 : 0.2, 0.0, 0.0));
  }
  return robot.build();
}

inline WorldBody free_box(const std::string& name, const Eigen::Vector3d& size, double mass,
                          const Eigen::Vector3d& position) {
  return body_of(std::make_shared<const Model>(single_shape_model(name, Box{size}, mass, {})), position);
}

/// The body, all its links with that surface.
inline WorldBody with_surface(WorldBody body, const Surface& surface) {
  Model model = *body.model;
  for (Link& link : model.links) link.surface = surface;
  body.model = std::make_shared<const Model>(std::move(model));
  return body;
}

/// A floor whose top is at z = 0.
inline WorldBody floor_body() {
  WorldBody floor = free_box("Floor", {10.0, 10.0, 0.2}, 0.0, {0.0, 0.0, -0.1});
  floor.fixed = true;
  return floor;
}

inline WorldSettings settings_of(SolverSettings::Method method) {
  WorldSettings settings;
  settings.solver.method = method;
  return settings;
}

inline WorldSettings weightless(SolverSettings::Method method = SolverSettings::Method::quick) {
  WorldSettings settings = settings_of(method);
  settings.gravity.setZero();
  return settings;
}

inline std::unique_ptr<World> make_world(const WorldSettings& settings, std::vector<WorldBody> bodies) {
  auto world = World::create(settings, std::move(bodies));
  if (world) return std::move(*world);
  ADD_FAILURE() << to_string(world.errors());
  return nullptr;
}

/// A command without effect, with an entry for everything in the observation.
inline Command idle(const World& world) {
  Command command;
  for (const BodyObservation& seen : world.sense().bodies) {
    BodyCommand& body = command.bodies.emplace_back();
    body.joints.resize(seen.joints.size());
    body.external.resize(seen.links.size());
    body.devices.resize(seen.devices.size());
  }
  return command;
}

inline JointCommand effort(double u) { return {drive_effort, 0.0, 0.0, u}; }
inline JointCommand velocity(double dq) { return {drive_velocity, 0.0, dq, 0.0}; }
inline JointCommand displacement(double q) { return {drive_displacement, q, 0.0, 0.0}; }

/// Runs with one command to one joint of the first body.
inline void run(World& world, int ticks, const JointCommand& joint, int id = 0) {
  Command command = idle(world);
  command.bodies[0].joints[id] = joint;
  for (int i = 0; i < ticks; ++i) {
    world.actuate(command);
    ASSERT_TRUE(world.step());
  }
}

/// Runs with the command given before.
inline void run(World& world, int ticks) {
  for (int i = 0; i < ticks; ++i) ASSERT_TRUE(world.step());
}

/// Runs without commands.
inline void let_go(World& world, int ticks) { run(world, ticks, JointCommand{}); }

inline const LinkReading& link_of(const World& world, int link = 0, int body = 0) {
  return world.sense().bodies[body].links[link];
}
inline const JointReading& joint_of(const World& world, int id = 0, int body = 0) {
  return world.sense().bodies[body].joints[id];
}
inline Eigen::Map<const Eigen::VectorXd> device_of(const World& world, int device, int body = 0) {
  const std::vector<double>& values = world.sense().bodies[body].devices[device].values;
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// Both are 3-vectors.
template <class A, class B>
void expect_near(const A& actual, const B& expected, double tolerance) {
  ASSERT_EQ(actual.size(), expected.size());
  for (Eigen::Index i = 0; i < expected.size(); ++i) EXPECT_NEAR(actual[i], expected[i], tolerance) << "element " << i;
}

inline void PrintTo(SolverSettings::Method method, std::ostream* stream) {
  *stream << SolverSettings::method_names[static_cast<std::size_t>(method)];
}

/// Tests that run with each solver.
class EachSolver : public ::testing::TestWithParam<SolverSettings::Method> {
 protected:
  WorldSettings settings() const { return settings_of(GetParam()); }
};

inline std::string solver_name(const ::testing::TestParamInfo<SolverSettings::Method>& method) {
  std::string name(SolverSettings::method_names[static_cast<std::size_t>(method.param)]);
  name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name;
}

/// For INSTANTIATE_TEST_SUITE_P(Solver, ..., each_solver, solver_name).
inline const auto each_solver =
    ::testing::Values(SolverSettings::Method::quick, SolverSettings::Method::exact, SolverSettings::Method::direct);

}  // namespace rehearse
