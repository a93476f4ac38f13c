// LinkPath: the links between two links of a body, both included. It may climb towards the root before it descends.
#pragma once

#include "Config.h"
#include "Link.h"

#include <cstddef>
#include <vector>

namespace cnoid {

class CNOID_GENERAL_EXPORT LinkPath {
 public:
  using container = std::vector<LinkPtr>;
  using iterator = container::iterator;
  using const_iterator = container::const_iterator;

  LinkPath() = default;
  LinkPath(Link* base, Link* end) { setPath(base, end); }
  /// Sets the path from the root link to `end`.
  explicit LinkPath(Link* end) { setPath(end); }

  /// False, and an empty path, if the links belong to different trees. Throws std::invalid_argument if one is null.
  bool setPath(Link* base, Link* end);
  void setPath(Link* end);

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

  /// Null if the path is empty.
  Link* baseLink() const { return empty() ? nullptr : links_.front().get(); }
  Link* endLink() const { return empty() ? nullptr : links_.back().get(); }
  Link* rootLink() const { return baseLink(); }
  Body* body() const { return empty() ? nullptr : links_.front()->body(); }

  /// True if the step from this link to the next goes from a parent to its child.
  bool isDownward(int index) const { return index >= numUpwardSteps_; }

  /// Computes poses (and velocities, accelerations) of the path's links from those of the base link and the joints' q
  /// (dq, ddq).
  void calcForwardKinematics(bool calcVelocity = false, bool calcAcceleration = false);

 private:
  std::vector<LinkPtr> links_;
  int numUpwardSteps_ = 0;
};

}  // namespace cnoid
