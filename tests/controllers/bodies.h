// Small robots for the tests of this folder.
#pragma once

#include <cnoid/Body>
#include <string>

namespace rehearse::test {

inline cnoid::Link* make_link(const std::string& name, cnoid::Link::JointType type, int joint_id = -1) {
  auto* link = new cnoid::Link;
  link->setName(name);
  link->setJointType(type);
  link->setJointId(joint_id);
  return link;
}

/// BASE (free) carries ARM (revolute about y, 1 m above it, joint SHOULDER, id 0), which carries HAND (prismatic along
/// x, 2 m beside it, id 1) and TOOL (fixed).
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

}  // namespace rehearse::test
