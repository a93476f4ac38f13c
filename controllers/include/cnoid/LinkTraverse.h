// LinkTraverse: links of a body in an order in which each follows the link that it is computed from.
//
// The links after the first are, first, those on the way from the first link up to the root (each is the parent of the
// link before it), then links whose parent is computed before them.
#pragma once

#include "Config.h"
#include "Link.h"

#include <cstddef>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT LinkTraverse {
 public:
  using container = std::vector<LinkPtr>;
  using iterator = container::iterator;
  using const_iterator = container::const_iterator;

  LinkTraverse() = default;
  /// See find().
  explicit LinkTraverse(Link* root, bool toUpper = false, bool toLower = true);
  LinkTraverse(const LinkTraverse&) = default;
  LinkTraverse& operator=(const LinkTraverse&) = default;
  virtual ~LinkTraverse();

  void clear();

  /// `toLower`: the link and all links below it. `toUpper`: also its parent, that link's parent, and so on, each with
  /// all links below it. Throws std::invalid_argument if the link is null.
  virtual void find(Link* root, bool toUpper = false, bool toLower = true);

  bool hasRootLowerLinks() const { return hasRootLowerLinks_; }
  bool hasRootUpperLinks() const { return hasRootUpperLinks_; }

  /// Adds a neighbour of the first link as the new first link.
  void insertRoot(Link* root);
  /// Adds a link at the end. `isLowerLink` false: it is the parent of the link that is the last so far, and no lower
  /// link has been added before.
  void append(Link* link, bool isLowerLink = true);
  /// Links behind the removed one are still computed from their parents. False if there is no such link, or if
  /// others are computed from it on the way up.
  bool remove(int index);
  bool remove(Link* link);

  /// Null if there are no links.
  Body* body() const { return empty() ? nullptr : links_.front()->body(); }
  Link* rootLink() const { return empty() ? nullptr : links_.front().get(); }

  bool empty() const { return links_.empty(); }
  std::size_t size() const { return links_.size(); }
  int numLinks() const { return static_cast<int>(links_.size()); }
  /// 0 to numLinks() - 1; not checked.
  Link* link(int index) const { return links_[static_cast<std::size_t>(index)]; }
  Link* operator[](int index) const { return link(index); }
  const std::vector<LinkPtr>& links() const { return links_; }
  iterator begin() { return links_.begin(); }
  iterator end() { return links_.end(); }
  const_iterator begin() const { return links_.begin(); }
  const_iterator end() const { return links_.end(); }

  /// False if the next link is the parent of this link.
  bool isDownward(int index) const { return index >= numUpwardSteps_; }

  /// Computes poses (and velocities, accelerations) of the links from those of the first link and the joints' q
  /// (dq, ddq).
  void calcForwardKinematics(bool calcVelocity = false, bool calcAcceleration = false);

  /// The efforts of the joints between these links. The motion of the first link and q, dq, ddq of the joints are
  /// given, and the links' T() must agree with them: call calcForwardKinematics() first.
  ///
  /// Writes u() of each revolute and prismatic joint [N·m, N], rotor inertia included, and v(), w(), dv(), dw() of all
  /// links but the first. Returns the wrench that must act on the first link, in world axes, its torque about the
  /// world's origin [N, N·m]. External forces of the links (F_ext) are taken into account; gravity is not, so add its
  /// opposite to dv() of the first link: (0, 0, 9.80665).
  Vector6 calcInverseDynamics();

 protected:
  std::vector<LinkPtr> links_;
  int numUpwardSteps_ = 0;
  bool hasRootLowerLinks_ = false;
  bool hasRootUpperLinks_ = false;

 private:
  void addLower(Link* link, const Link* except);
  /// The last place before `end` with the link, or -1.
  int placeBefore(int end, const Link* wanted) const;
  /// The link that this one is computed from, and the link whose joint is between them.
  Link* neighbour(int index) const { return index <= numUpwardSteps_ ? link(index - 1) : link(index)->parent(); }
  Link* jointLink(int index) const { return index <= numUpwardSteps_ ? link(index - 1) : link(index); }
};

}  // namespace cnoid
