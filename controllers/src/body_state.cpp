#include <algorithm>
#include <cnoid/Body>
#include <cnoid/BodyStateSeq>

namespace cnoid {

BodyState& BodyState::allocate(int numLinks, int numJoints, int numDevices) {
  linkPositions_.assign(static_cast<std::size_t>(numLinks) * LinkPosition::size, 0.0);
  for (int i = 0; i < numLinks; ++i) linkPosition(i).set(Isometry3::Identity());
  jointDisplacements_.assign(static_cast<std::size_t>(numJoints), 0.0);
  deviceStates_.assign(static_cast<std::size_t>(numDevices), nullptr);
  return *this;
}

void BodyState::store(const Body& body, bool withDevices) {
  allocate(body.numLinks(), body.numAllJoints(), withDevices ? body.numDevices() : 0);
  for (int i = 0; i < numLinkPositions(); ++i) linkPosition(i).set(body.link(i)->T());
  for (int i = 0; i < numJointDisplacements(); ++i) jointDisplacement(i) = body.joint(i)->q();
  for (int i = 0; i < numDeviceStates(); ++i) setDeviceState(i, body.device(i)->cloneState());
}

bool BodyState::restore(Body& body, bool withDevices) const {
  const int numJoints = std::min(numJointDisplacements(), body.numAllJoints());
  for (int i = 0; i < numJoints; ++i) body.joint(i)->q() = jointDisplacement(i);
  const int numLinks = std::min(numLinkPositions(), body.numLinks());
  if (numLinks > 0) {
    body.rootLink()->setPosition(linkPosition(0).T());
    body.calcForwardKinematics();
  }
  for (int i = 1; i < numLinks; ++i) body.link(i)->setPosition(linkPosition(i).T());
  const int numDevices = withDevices ? std::min(numDeviceStates(), body.numDevices()) : 0;
  for (int i = 0; i < numDevices; ++i) {
    if (!deviceState(i)) continue;
    body.device(i)->copyStateFrom(*deviceState(i));
    body.device(i)->notifyStateChange();
  }
  return numJoints > 0 || numLinks > 0;
}

BodyState& operator<<(BodyState& state, const Body& body) {
  state.storeStateOfBody(&body);
  return state;
}

const BodyState& operator>>(const BodyState& state, Body& body) {
  state.restoreStateToBody(&body);
  return state;
}

Body& operator<<(Body& body, const BodyState& state) {
  state.restoreStateToBody(&body);
  return body;
}

const Body& operator>>(const Body& body, BodyState& state) {
  state.storeStateOfBody(&body);
  return body;
}

BodyStateSeq::BodyStateSeq(int numFrames) : Seq("BodyStateSeq") { setNumFrames(numFrames); }

BodyStateSeq::~BodyStateSeq() = default;

std::shared_ptr<AbstractSeq> BodyStateSeq::cloneSeq() const { return std::make_shared<BodyStateSeq>(*this); }

}  // namespace cnoid
