#include <cnoid/Body>
#include <cnoid/JointTraverse>

#include <algorithm>

#include "id_order.h"

namespace cnoid {

JointTraverse::JointTraverse(Body* body) : linkTraverse_(body->linkTraverse()) {
  for (const auto& joint : body->joints()) {
    if (joint->isValid()) joints_.push_back(joint);
  }
}

JointTraverse::JointTraverse(Link* baseLink, bool toUpper, bool toLower) : linkTraverse_(baseLink, toUpper, toLower) {
  for (const auto& link : linkTraverse_) appendJoint(link);
}

void JointTraverse::clear() {
  linkTraverse_.clear();
  joints_.clear();
}

bool JointTraverse::appendJoint(Link* joint) {
  if (!joint->hasActualJoint()) return false;
  joints_.push_back(joint);
  return true;
}

int JointTraverse::jointIndexAtIdOrder(int index) const { return placeInIdOrder(joints_, index); }

bool JointTraverse::remove(Link* link) {
  const bool wasLink = linkTraverse_.remove(link);
  const auto place = std::find(joints_.begin(), joints_.end(), LinkPtr(link));
  if (place == joints_.end()) return wasLink;
  joints_.erase(place);
  return true;
}

}  // namespace cnoid
