// Small robots for the tests of this folder.
#pragma once

#include <cmath>
#include <cnoid/Body>
#include <cnoid/EigenUtil>
#include <cnoid/ValueTree>
#include <string>

namespace rehearse::test {

inline cnoid::Link* make_link(const std::string& name, cnoid::Link::JointType type, int joint_id = -1) {
  auto* link = new cnoid::Link;
  link->setName(name);
  link->setJointType(type);
  link->setJointId(joint_id);
  return link;
}

/// BASE (free) has the child ARM (revolute about y, 1 m above it, joint SHOULDER, id 0). ARM has the children HAND
/// (prismatic along x, 2 m beside it, id 1) and TOOL (fixed).
inline cnoid::BodyPtr make_arm() {
  auto* base = make_link("BASE", cnoid::Link::FreeJoint);
  auto* arm = make_link("ARM", cnoid::Link::RevoluteJoint, 0);
  arm->setJointName("SHOULDER");
  arm->setJointAxis(cnoid::Vector3::UnitY());
  arm->setOffsetTranslation(cnoid::Vector3(0, 0, 1));
  auto* hand = make_link("HAND", cnoid::Link::PrismaticJoint, 1);
  hand->setJointAxis(cnoid::Vector3::UnitX());
  hand->setOffsetTranslation(cnoid::Vector3(2, 0, 0));
  auto* tool = make_link("TOOL", cnoid::Link::FixedJoint);
  base->appendChild(arm);
  arm->appendChild(hand);
  arm->appendChild(tool);

  cnoid::BodyPtr body = new cnoid::Body("arm");
  body->setModelName("ARM_MODEL");
  body->setRootLink(base);
  return body;
}

/// An arm of six revolute joints on a fixed base: yaw, three pitches, then yaw and pitch of the wrist. About 1.2 m
/// long. Links L1 to L6, joint ids 0 to 5.
inline cnoid::BodyPtr make_six_joint_arm() {
  const cnoid::Vector3 axes[] = {cnoid::Vector3::UnitZ(), cnoid::Vector3::UnitY(), cnoid::Vector3::UnitY(),
                                 cnoid::Vector3::UnitX(), cnoid::Vector3::UnitY(), cnoid::Vector3::UnitX()};
  const cnoid::Vector3 offsets[] = {{0, 0, 0.2}, {0, 0, 0.1}, {0, 0, 0.4}, {0.1, 0, 0.05}, {0.3, 0, 0}, {0.1, 0, 0}};
  cnoid::Link* parent = make_link("BASE", cnoid::Link::FixedJoint);
  cnoid::BodyPtr body = new cnoid::Body("six_joint_arm");
  body->setRootLink(parent);
  for (int i = 0; i < 6; ++i) {
    cnoid::Link* link = make_link("L" + std::to_string(i + 1), cnoid::Link::RevoluteJoint, i);
    link->setJointAxis(axes[i]);
    link->setOffsetTranslation(offsets[i]);
    parent->appendChild(link);
    parent = link;
  }
  body->updateLinkTree();
  return body;
}

/// A free WAIST (1 m high) with two legs of six revolute joints (hip yaw, roll, pitch; knee; ankle pitch, roll; ids 0
/// to 5 of RIGHT1 to RIGHT6, 6 to 11 of LEFT1 to LEFT6), a CHEST (revolute, id 12), a HEAD on it (prismatic, id 13),
/// and an ANTENNA (revolute, without an id). Nothing is symmetric; the legs are bent. Its information names two feet
/// and groups.
inline cnoid::BodyPtr make_biped() {
  using cnoid::Vector3;
  auto* waist = make_link("WAIST", cnoid::Link::FreeJoint);
  waist->setOffsetTranslation(Vector3(0, 0, 1));
  cnoid::BodyPtr body = new cnoid::Body("biped");
  body->setRootLink(waist);
  const auto add = [](cnoid::Link* parent, const std::string& name, cnoid::Link::JointType type, int id,
                      const Vector3& axis, const Vector3& place, double q) {
    auto* link = make_link(name, type, id);
    link->setJointAxis(axis);
    link->setOffsetTranslation(place);
    link->setInitialJointDisplacement(q);
    parent->appendChild(link);
    return link;
  };
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  const Vector3 axes[] = {z, x, y, y, y, x};
  const Vector3 places[] = {{0, 0, -0.1}, {0, 0, 0}, {0, 0, 0}, {0, 0.01, -0.4}, {0, 0, -0.4}, {0, 0, 0}};
  const double bends[] = {0.0, 0.02, -0.4, 0.8, -0.4, -0.02};
  for (const double side : {-1.0, 1.0}) {
    cnoid::Link* parent = waist;
    for (int i = 0; i < 6; ++i) {
      const std::string name = (side < 0 ? "RIGHT" : "LEFT") + std::to_string(i + 1);
      const Vector3 place = places[i] + (i == 0 ? Vector3(0, side * 0.1, 0) : Vector3(0, 0, 0));
      parent = add(parent, name, cnoid::Link::RevoluteJoint, (side < 0 ? 0 : 6) + i, axes[i], place, bends[i]);
    }
  }
  auto* chest = add(waist, "CHEST", cnoid::Link::RevoluteJoint, 12, Vector3(1, 2, 2) / 3.0, {0.02, 0, 0.2}, 0.1);
  add(chest, "HEAD", cnoid::Link::PrismaticJoint, 13, Vector3(3, 0, 4) / 5.0, {0, 0.03, 0.3}, 0.05);
  add(chest, "ANTENNA", cnoid::Link::RevoluteJoint, -1, y, {-0.1, 0, 0.2}, 0.3);
  body->updateLinkTree();
  for (const auto& link : body->links()) {
    const double i = link->index();
    link->setMass(1.0 + std::fmod(i, 4.0));
    link->setCenterOfMass(Vector3(0.01 * i - 0.055, 0.033 - 0.005 * i, 0.01 - 0.02 * std::fmod(i, 3.0)));
    const cnoid::Matrix3 turn = cnoid::rotFromRpy(0.1 * i, 0.2, -0.05 * i);
    link->setInertia(turn * Vector3(0.02, 0.03 + 0.001 * i, 0.04).asDiagonal() * turn.transpose());
    if (!link->isRoot()) link->setEquivalentRotorInertia(0.01 + 0.001 * i);
  }
  auto* feet = body->info()->createListing("foot_links");
  for (const char* name : {"LEFT6", "RIGHT6"}) {
    cnoid::Mapping* foot = feet->newMapping();
    foot->write("link", name);
    auto* sole = foot->createListing("sole_center");
    for (const double number : {0.05, 0.0, -0.08}) sole->append(new cnoid::ScalarNode(number));
  }
  body->initializePosition();
  return body;
}

/// Gives all joints and the root different displacements, velocities and accelerations.
inline void stir(cnoid::Body& body) {
  cnoid::Link& root = *body.rootLink();
  root.T().rotate(cnoid::AngleAxis(0.4, cnoid::Vector3(1, -2, 2) / 3.0));
  root.T().pretranslate(cnoid::Vector3(0.3, -0.5, 0.1));
  root.v() = cnoid::Vector3(0.3, -0.2, 0.5);
  root.w() = cnoid::Vector3(-0.7, 0.4, 0.9);
  root.dv() = cnoid::Vector3(1.1, 0.6, -0.8);
  root.dw() = cnoid::Vector3(0.5, -1.3, 0.7);
  for (const auto& joint : body.allJoints()) {
    const double i = joint->index();
    joint->q() += 0.3 * std::sin(i);
    joint->dq() = std::cos(2.0 * i);
    joint->ddq() = 2.0 * std::sin(3.0 * i + 1.0);
  }
  body.calcForwardKinematics(true, true);
}

/// Moves root and joints along a short time [s] with their velocities and accelerations, and computes forward
/// kinematics. Exact to the second order of time.
inline void advance(cnoid::Body& body, double time) {
  cnoid::Link& root = *body.rootLink();
  const cnoid::Vector3 turn = time * root.w() + 0.5 * time * time * root.dw();
  root.p() += time * root.v() + 0.5 * time * time * root.dv();
  if (turn.norm() > 0.0) {
    root.R() = (cnoid::AngleAxis(turn.norm(), turn.normalized()) * cnoid::Matrix3(root.R())).eval();
  }
  root.v() += time * root.dv();
  root.w() += time * root.dw();
  for (const auto& joint : body.allJoints()) {
    joint->q() += time * joint->dq() + 0.5 * time * time * joint->ddq();
    joint->dq() += time * joint->ddq();
  }
  body.calcForwardKinematics(true, true);
}

}  // namespace rehearse::test
