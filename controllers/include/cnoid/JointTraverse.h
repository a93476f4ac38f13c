// JointTraverse: the joints of a LinkTraverse.
#pragma once

#include "LinkTraverse.h"

#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT JointTraverse {
 public:
  using iterator = std::vector<LinkPtr>::iterator;
  using const_iterator = std::vector<LinkPtr>::const_iterator;

  JointTraverse() = default;
  /// All links of the body, and the joints with an id in the order of their ids.
  explicit JointTraverse(Body* body);
  /// LinkTraverse::find, and those of the links that have a revolute or prismatic joint.
  explicit JointTraverse(Link* baseLink, bool toUpper = false, bool toLower = true);

  void clear();
  bool empty() const { return linkTraverse_.empty() && joints_.empty(); }
  Body* body() const { return linkTraverse_.body(); }

  LinkTraverse& linkTraverse() { return linkTraverse_; }
  const LinkTraverse& linkTraverse() const { return linkTraverse_; }
  void appendLink(Link* link, bool isLowerLink = true) { linkTraverse_.append(link, isLowerLink); }
  int numLinks() const { return linkTraverse_.numLinks(); }
  /// 0 to numLinks() - 1; not checked.
  Link* link(int index) const { return linkTraverse_.link(index); }

  /// False if the link has no revolute or prismatic joint.
  bool appendJoint(Link* joint);
  int numJoints() const { return static_cast<int>(joints_.size()); }
  /// 0 to numJoints() - 1; not checked.
  Link* joint(int index) const { return joints_[static_cast<std::size_t>(index)]; }
  const std::vector<LinkPtr>& joints() const { return joints_; }
  /// The joints in the order of their ids. Throws std::out_of_range.
  int jointIndexAtIdOrder(int index) const;
  Link* jointAtIdOrder(int index) const { return joint(jointIndexAtIdOrder(index)); }

  /// Removes the link from the links and from the joints. False if it is in neither.
  bool remove(Link* link);

  iterator begin() { return joints_.begin(); }
  iterator end() { return joints_.end(); }
  const_iterator begin() const { return joints_.begin(); }
  const_iterator end() const { return joints_.end(); }

  void calcForwardKinematics(bool calcVelocity = false, bool calcAcceleration = false) {
    linkTraverse_.calcForwardKinematics(calcVelocity, calcAcceleration);
  }

 private:
  LinkTraverse linkTraverse_;
  std::vector<LinkPtr> joints_;
};

}  // namespace cnoid
