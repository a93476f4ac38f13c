// Forward kinematics along the tree: Body::calcForwardKinematics.

#include <cnoid/Body>

#include "link_motion.h"

namespace cnoid {

void Body::calcForwardKinematics(bool calcVelocity, bool calcAcceleration) {
  for (const auto& link : links_) {  // a parent always comes before its children
    if (link->isRoot()) continue;
    setPose(*link, *link->parent());
    if (calcVelocity) setVelocity(*link, *link->parent());
    if (calcVelocity && calcAcceleration) setAcceleration(*link, *link->parent());
  }
}

}  // namespace cnoid
