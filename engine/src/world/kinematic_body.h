// KinematicBody: a body that moves as commanded, without dynamics. Private to the world library.
//
// Joint commands (displacement before velocity) and the root's pose determine its configuration at the end of the
// coming step; link poses follow by forward kinematics. It pushes other bodies with the velocity that takes it there,
// and no body pushes it.
#pragma once

#include <ode/ode.h>

#include <vector>

#include "simulated_body.h"

namespace rehearse {

class KinematicBody final : public SimulatedBody {
 public:
  KinematicBody(dWorldID world, WorldBody description, double time_step);

  void before_step(double) override {}
  void drive(const BodyCommand& command) override;
  void add_wrench(int, const Eigen::Vector3d&, const Eigen::Vector3d&) override {}
  Eigen::Vector3d link_point(int link, const Eigen::Vector3d& point_in_link) const override;
  Belt belt(int index) const override;
  Mount mount(int link) const override { return {bodies_[link], Eigen::Isometry3d::Identity()}; }
  void after_step() override;
  void observe(BodyObservation& observation, const WorldSettings& settings, bool stepped) const override;
  bool plausible() const override;
  std::vector<dBodyID> ode_bodies() const override;
  void visit_state(StateVisitor& visitor) override;
  void after_restore() override { place(); }
  void take_centers(const SimulatedBody&) override {}  // its state contains link poses, not centres of mass
  void nudge(std::uint64_t) override {}                // it moves exactly as commanded

 private:
  void read_force(std::size_t, std::vector<double>& values) const override { values.assign(6, 0.0); }  // no force
  void create_shapes(dWorldID world);
  std::vector<Eigen::Isometry3d> poses() const;
  void place();
  double wanted_displacement(std::size_t id, const JointCommand& command) const;
  double kept(const Joint& joint, double displacement) const;

  double time_step_;
  std::vector<dBodyID> bodies_;  // by link index; null: the link has no shapes
  // state
  std::vector<JointReading> joints_;  // by joint id
  std::vector<LinkReading> links_;    // by link index
  // scratch within a step
  std::vector<JointReading> next_joints_;
  std::vector<LinkReading> next_links_;
};

}  // namespace rehearse
