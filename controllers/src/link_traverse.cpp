#include <cnoid/InverseDynamics>
#include <cnoid/LinkTraverse>

#include <cstddef>
#include <stdexcept>

#include "link_motion.h"

namespace cnoid {

namespace {

/// What must act on a link so that it moves as it does: force, and torque about the world's origin.
Vector6 inertialWrench(const Link& link) {
  const Vector3 arm = link.R() * link.c();
  const Matrix3 inertia = link.R() * link.I() * link.R().transpose();
  const Vector3 acceleration = link.dv() + link.dw().cross(arm) + link.w().cross(link.w().cross(arm));
  Vector6 wrench;
  wrench.head<3>() = link.m() * acceleration;
  wrench.tail<3>() =
      (link.p() + arm).cross(Vector3(wrench.head<3>())) + inertia * link.dw() + link.w().cross(inertia * link.w());
  return wrench;
}

/// The joint's effort, if `wrench` acts through it on the link's side.
double effort(const Link& joint, const Vector6& wrench) {
  const Vector3 axis = joint.R() * joint.a();
  const Vector3 force = wrench.head<3>();
  const double load = joint.isPrismaticJoint() ? axis.dot(force) : axis.dot(wrench.tail<3>() - joint.p().cross(force));
  return load + joint.Jm2() * joint.ddq();
}

}  // namespace

LinkTraverse::LinkTraverse(Link* root, bool toUpper, bool toLower) { LinkTraverse::find(root, toUpper, toLower); }

LinkTraverse::~LinkTraverse() = default;

void LinkTraverse::clear() {
  links_.clear();
  numUpwardSteps_ = 0;
  hasRootLowerLinks_ = false;
  hasRootUpperLinks_ = false;
}

void LinkTraverse::find(Link* root, bool toUpper, bool toLower) {
  if (!root) throw std::invalid_argument("the links above or below a link need a link: it is null");
  clear();
  links_.push_back(root);
  if (toUpper) {
    for (Link* link = root->parent(); link; link = link->parent()) links_.push_back(link);
  }
  numUpwardSteps_ = numLinks() - 1;
  // From the top down, so that each part begins beside a link that is there already.
  for (int i = numUpwardSteps_; i > 0; --i) addLower(link(i), link(i - 1));
  if (toLower) addLower(root, nullptr);
  hasRootUpperLinks_ = numUpwardSteps_ > 0;
  hasRootLowerLinks_ = toLower && root->child();
}

void LinkTraverse::addLower(Link* link, const Link* except) {
  for (Link* child = link->child(); child; child = child->sibling()) {
    if (child == except) continue;
    links_.push_back(child);
    addLower(child, nullptr);
  }
}

int LinkTraverse::placeBefore(int end, const Link* wanted) const {
  int place = end - 1;
  while (place >= 0 && link(place) != wanted) --place;
  return place;
}

void LinkTraverse::insertRoot(Link* root) {
  if (!empty() && root->parent() == rootLink()) {
    ++numUpwardSteps_;
    hasRootUpperLinks_ = true;
  } else {
    hasRootLowerLinks_ = hasRootLowerLinks_ || !empty();
  }
  links_.insert(links_.begin(), root);
}

void LinkTraverse::append(Link* link, bool isLowerLink) {
  if (!isLowerLink && (empty() || numLinks() != numUpwardSteps_ + 1 || links_.back()->parent() != link)) {
    throw std::invalid_argument("an upper link is the parent of the last link, before any lower link");
  }
  if (!isLowerLink) ++numUpwardSteps_;
  hasRootUpperLinks_ = numUpwardSteps_ > 0;
  hasRootLowerLinks_ = hasRootLowerLinks_ || (isLowerLink && !empty());
  links_.push_back(link);
}

bool LinkTraverse::remove(int index) {
  if (index < 0 || index >= numLinks()) return false;
  if (numUpwardSteps_ > 0) {
    if (index > 0 && index <= numUpwardSteps_) return false;
    if (index == 0) --numUpwardSteps_;
  }
  links_.erase(links_.begin() + index);
  hasRootUpperLinks_ = numUpwardSteps_ > 0;
  hasRootLowerLinks_ = numLinks() - numUpwardSteps_ >= 2;
  return true;
}

bool LinkTraverse::remove(Link* link) {
  for (int i = 0; i < numLinks(); ++i) {
    if (this->link(i) == link) return remove(i);
  }
  return false;
}

void LinkTraverse::calcForwardKinematics(bool calcVelocity, bool calcAcceleration) {
  for (int i = 1; i < numLinks(); ++i) {
    Link* from = neighbour(i);
    if (!from) continue;  // a root that was appended
    Link& to = *link(i);
    const bool isDown = i > numUpwardSteps_;
    isDown ? setPose(to, *from) : setPoseOfParent(to, *from);
    if (!calcVelocity) continue;
    isDown ? setVelocity(to, *from) : setVelocityOfParent(to, *from);
    if (!calcAcceleration) continue;
    isDown ? setAcceleration(to, *from) : setAccelerationOfParent(to, *from);
  }
}

Vector6 LinkTraverse::calcInverseDynamics() {
  if (empty()) return Vector6::Zero();
  // The place of each link's neighbour in the order, because a wrench goes on to it.
  std::vector<int> from(links_.size(), -1);
  for (int i = 1; i < numLinks(); ++i) {
    Link& to = *link(i);
    const bool isDown = i > numUpwardSteps_;
    const int place = isDown ? placeBefore(i, to.parent()) : i - 1;
    if (place < 0)
      throw std::logic_error("inverse dynamics: the parent of link " + to.name() + " is not among the links");
    from[static_cast<std::size_t>(i)] = place;
    const Link& near = *link(place);
    isDown ? setVelocity(to, near) : setVelocityOfParent(to, near);
    isDown ? setAcceleration(to, near) : setAccelerationOfParent(to, near);
  }
  std::vector<Vector6, Eigen::aligned_allocator<Vector6>> wrenches(links_.size(), Vector6::Zero());
  for (int i = numLinks() - 1; i >= 0; --i) {
    Vector6& wrench = wrenches[static_cast<std::size_t>(i)];
    wrench += inertialWrench(*link(i)) - link(i)->F_ext();
    if (i == 0) break;
    wrenches[static_cast<std::size_t>(from[static_cast<std::size_t>(i)])] += wrench;
    Link& joint = *jointLink(i);
    if (!joint.hasActualJoint()) continue;
    // On the way up the wrench acts on the parent's side of the joint.
    joint.u() = effort(joint, i > numUpwardSteps_ ? wrench : Vector6(-wrench));
  }
  return wrenches[0];
}

Vector6 calcInverseDynamics(Link* link) {
  if (Link* parent = link->parent()) {
    setVelocity(*link, *parent);
    setAcceleration(*link, *parent);
  }
  const Vector6 wrench = LinkTraverse(link).calcInverseDynamics();
  if (link->parent() && link->hasActualJoint()) link->u() = effort(*link, wrench);
  return wrench;
}

}  // namespace cnoid
