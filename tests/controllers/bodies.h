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

}  // namespace rehearse::test
