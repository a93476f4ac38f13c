#include <algorithm>
#include <cnoid/LinkPath>
#include <stdexcept>

#include "link_motion.h"

namespace cnoid {

namespace {

/// The link, its parent, and so on to the root.
std::vector<LinkPtr> wayToRoot(Link* link) {
  std::vector<LinkPtr> way;
  for (; link; link = link->parent()) way.push_back(link);
  return way;
}

}  // namespace

bool LinkPath::setPath(Link* base, Link* end) {
  if (!base || !end) throw std::invalid_argument("a path between links needs two links: one of them is null");
  links_ = wayToRoot(base);
  std::vector<LinkPtr> down = wayToRoot(end);
  if (links_.back() != down.back()) {
    links_.clear();
    numUpwardSteps_ = 0;
    return false;
  }
  // The common part of both ways above the link where they meet does not belong to the path.
  LinkPtr meeting;
  while (!links_.empty() && !down.empty() && links_.back() == down.back()) {
    meeting = links_.back();
    links_.pop_back();
    down.pop_back();
  }
  numUpwardSteps_ = numLinks();
  links_.push_back(meeting);
  links_.insert(links_.end(), down.rbegin(), down.rend());
  return true;
}

void LinkPath::setPath(Link* end) {
  links_ = wayToRoot(end);
  std::reverse(links_.begin(), links_.end());
  numUpwardSteps_ = 0;
}

void LinkPath::calcForwardKinematics(bool calcVelocity, bool calcAcceleration) {
  for (int i = 1; i < numLinks(); ++i) {
    const Link& from = *link(i - 1);
    Link& to = *link(i);
    const bool isDown = isDownward(i - 1);
    isDown ? setPose(to, from) : setPoseOfParent(to, from);
    if (!calcVelocity) continue;
    isDown ? setVelocity(to, from) : setVelocityOfParent(to, from);
    if (!calcAcceleration) continue;
    isDown ? setAcceleration(to, from) : setAccelerationOfParent(to, from);
  }
}

}  // namespace cnoid
