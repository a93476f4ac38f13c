#include <algorithm>
#include <cnoid/CompositeIK>
#include <cnoid/JointPath>

#include "posture.h"
#include "remaining_links.h"

namespace cnoid {

void CompositeIK::reset(Body* body, Link* targetLink) {
  body_ = body;
  targetLink_ = targetLink;
  paths_.clear();
}

bool CompositeIK::addBaseLink(Link* link) {
  if (!link || !targetLink_) return false;
  const auto path = JointPath::getCustomPath(link, targetLink_);
  if (path->linkPath().empty()) return false;
  for (const auto& other : paths_) {
    const auto isShared = [&other](const LinkPtr& joint) { return other->indexOf(joint) >= 0; };
    if (std::any_of(path->begin(), path->end(), isShared)) return false;
  }
  paths_.push_back(path);
  return true;
}

Link* CompositeIK::baseLink(int index) const { return jointPath(index)->baseLink(); }

void CompositeIK::setMaxIkError(double tolerance) {
  for (const auto& path : paths_) path->setNumericalIkMaxIkError(tolerance);
}

bool CompositeIK::calcInverseKinematics(const Isometry3& T) {
  if (paths_.empty()) return false;
  const Isometry3 goal = T;  // a copy, because T may refer to the pose of a link that moves
  const Isometry3 start = targetLink_->T();
  const Posture before(*body_);
  bool isSolved = true;
  for (const auto& path : paths_) {
    targetLink_->setPosition(start);  // each path begins at poses that agree with its displacements
    isSolved = path->calcInverseKinematics(goal);
    if (!isSolved) break;
  }
  if (isSolved) {
    targetLink_->setPosition(goal);
    return true;
  }
  before.restore(*body_);
  return false;
}

bool CompositeIK::calcRemainingPartForwardKinematicsForInverseKinematics() {
  if (paths_.empty()) return false;
  std::vector<const LinkPath*> links;
  for (const auto& path : paths_) links.push_back(&path->linkPath());
  calcRemainingForwardKinematics(*targetLink_, links);
  return true;
}

}  // namespace cnoid
