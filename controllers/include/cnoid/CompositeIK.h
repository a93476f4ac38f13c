// CompositeIK: moves a link to a pose while several other links stay where they are, as a waist between two feet.
#pragma once

#include "Body.h"
#include "InverseKinematics.h"

#include <memory>
#include <vector>

namespace cnoid {

class JointPath;

class CNOID_GENERAL_EXPORT CompositeIK : public InverseKinematics {
 public:
  CompositeIK() = default;
  CompositeIK(Body* body, Link* targetLink) { reset(body, targetLink); }

  void reset(Body* body, Link* targetLink);
  /// Adds a link that stays in place. False if there is no path from it to the target link, or if a joint of this path
  /// belongs to the path of another base link: they could not be solved one after the other.
  bool addBaseLink(Link* link);

  Body* body() const { return body_; }
  Link* targetLink() const { return targetLink_; }
  int numJointPaths() const { return static_cast<int>(paths_.size()); }
  /// From the base link of this number to the target link. Not checked.
  std::shared_ptr<JointPath> jointPath(int index) const { return paths_[static_cast<std::size_t>(index)]; }
  Link* baseLink(int index) const;

  void setMaxIkError(double tolerance);
  bool hasCustomIK() const { return false; }

  using InverseKinematics::calcInverseKinematics;
  /// Solves the path from each base link. True: all have reached the goal, and the target link's pose is exactly T.
  /// False, if one has not, or if there is no base link: joints and links are as before.
  bool calcInverseKinematics(const Isometry3& T) override;
  /// Computes the poses of all links of the body that are not on a path.
  bool calcRemainingPartForwardKinematicsForInverseKinematics() override;

  [[deprecated("Use setMaxIkError.")]] void setMaxIKerror(double tolerance) { setMaxIkError(tolerance); }
  [[deprecated("Use hasCustomIK.")]] bool hasAnalyticalIK() const { return hasCustomIK(); }

 private:
  BodyPtr body_;
  LinkPtr targetLink_;
  std::vector<std::shared_ptr<JointPath>> paths_;
};

}  // namespace cnoid
