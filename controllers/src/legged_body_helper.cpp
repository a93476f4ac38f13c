#include <cnoid/CompositeIK>
#include <cnoid/JointPath>
#include <cnoid/LeggedBodyHelper>

#include <initializer_list>
#include <stdexcept>
#include <string>

#include "posture.h"

namespace cnoid {

namespace {

/// False if the key is missing. Throws if the value is not a list of three numbers.
bool readVector(const Mapping& entry, std::initializer_list<const char*> keys, Vector3& out) {
  const ValueNode* node = entry.find(keys);
  if (!node->isValid()) return false;
  const Listing& numbers = *node->toListing();
  if (numbers.size() != 3) node->throwException(std::string("'") + *keys.begin() + "' needs 3 numbers");
  for (int i = 0; i < 3; ++i) out[i] = numbers[i].toDouble();
  return true;
}

}  // namespace

LeggedBodyHelper* getLeggedBodyHelper(Body* body) {
  auto* helper = body->getOrCreateCache<LeggedBodyHelper>("LeggedBodyHelper");
  if (!helper->body()) helper->resetBody(body);
  return helper;
}

LeggedBodyHelper::LeggedBodyHelper(const LeggedBodyHelper& other) : Referenced(other) {
  if (other.body_) LeggedBodyHelper::resetBody(other.body_);
}

LeggedBodyHelper::~LeggedBodyHelper() = default;

bool LeggedBodyHelper::resetBody(Body* body) {
  body_ = body;
  feet_.clear();
  zmpDevice_.reset();
  const Listing* entries = body->info()->findListing({"foot_links", "footLinks"});
  if (!entries->isValid()) return false;
  for (const auto& node : *entries) {
    const Mapping& entry = *node->toMapping();
    Foot foot;
    foot.link = linkOf(entry.get<std::string>("link"));
    if (!readVector(entry, {"sole_center", "soleCenter"}, foot.soleCenter)) {
      entry.throwException("a foot needs 'sole_center'");
    }
    if (!readVector(entry, {"home_cop", "homeCop"}, foot.homeCop)) foot.homeCop = foot.soleCenter;
    Vector3 toe = Vector3::Zero();
    readVector(entry, {"toe_offset", "toeOffset"}, toe);
    foot.toeOffset = Translation3(toe);
    std::string knee;
    if (entry.read({"knee_pitch_joint", "kneePitchJoint"}, knee)) foot.kneePitchJoint = body->joint(knee);
    feet_.push_back(foot);
  }
  return isValid();
}

Link* LeggedBodyHelper::linkOf(const std::string& name) const {
  Link* link = body_->link(name);
  if (!link) throw std::invalid_argument("foot_links: body " + body_->name() + " has no link " + name);
  return link;
}

Vector3 LeggedBodyHelper::centerOfSoles() const {
  if (!isValid()) throw std::logic_error("centerOfSoles: the body has no feet");
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < numFeet(); ++i) sum += centerOfSole(i);
  return sum / numFeet();
}

Vector3 LeggedBodyHelper::homeCopOfSoles() const {
  if (!isValid()) throw std::logic_error("homeCopOfSoles: the body has no feet");
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < numFeet(); ++i) sum += homeCopOfSole(i);
  return sum / numFeet();
}

std::shared_ptr<InverseKinematics> LeggedBodyHelper::getFootBasedIK(Link* targetLink) {
  if (!isValid()) return nullptr;
  auto ik = std::make_shared<CompositeIK>(body_, targetLink);
  for (const Foot& foot : feet_) {
    if (!ik->addBaseLink(foot.link)) return nullptr;
  }
  return ik;
}

bool LeggedBodyHelper::moveTo(const Isometry3& root, const Poses& feet) {
  Link* waist = body_->rootLink();
  JointPath supporting(feet_[0].link, waist);
  if (!supporting.setBaseLinkGoal(feet[0]).calcInverseKinematics(root)) return false;
  body_->calcForwardKinematics();
  for (std::size_t i = 1; i < feet_.size(); ++i) {
    if (!JointPath(waist, feet_[i].link).calcInverseKinematics(feet[i])) return false;
  }
  body_->calcForwardKinematics();
  return true;
}

LeggedBodyHelper::Poses LeggedBodyHelper::poses() const {
  Poses all;
  for (const Foot& foot : feet_) all.push_back(foot.link->T());
  return all;
}

bool LeggedBodyHelper::doLegIkToMoveCm(const Vector3& c, bool onlyProjectionToFloor) {
  if (!isValid()) return false;
  constexpr int maxIterations = 100;
  constexpr double tolerance = 1.0e-6;  // [m]
  const Posture start(*body_);
  const Poses feet = poses();
  for (int i = 0; i < maxIterations; ++i) {
    Vector3 error = c - body_->calcCenterOfMass();
    if (onlyProjectionToFloor) error.z() = 0.0;
    if (error.norm() < tolerance) return true;
    Isometry3 root = body_->rootLink()->T();
    root.pretranslate(error);
    if (!moveTo(root, feet)) break;
  }
  start.restore(*body_);
  body_->calcCenterOfMass();
  return false;
}

bool LeggedBodyHelper::setStance(double width, Link* baseLink) {
  if (numFeet() != 2) return false;
  const int standing = footLink(1) == baseLink ? 1 : 0;
  const int moved = 1 - standing;
  Poses feet = poses();
  const auto& base = feet[static_cast<std::size_t>(standing)];
  auto& other = feet[static_cast<std::size_t>(moved)];
  Vector3 side = base.linear().col(1);
  side.z() = 0.0;
  side.normalize();
  if (side.dot(other.translation() - base.translation()) < 0.0) side = -side;
  other.translation() = base.translation() + width * side;
  Isometry3 root = body_->rootLink()->T();
  root.translation().head<2>() = (base.translation() + other.translation()).head<2>() / 2.0;

  const Posture start(*body_);
  if (moveTo(root, feet)) return true;
  start.restore(*body_);
  return false;
}

ZmpDevice* LeggedBodyHelper::getOrCreateZmpDevice() {
  if (!isValid()) return nullptr;
  if (!zmpDevice_) zmpDevice_ = body_->findDevice<ZmpDevice>();
  if (!zmpDevice_) {
    zmpDevice_ = new ZmpDevice;
    body_->addDevice(zmpDevice_, body_->rootLink());
  }
  return zmpDevice_;
}

Vector3 LeggedBodyHelper::zmp() const { return zmpDevice_ ? zmpDevice_->zmp() : Vector3(Vector3::Zero()); }

void LeggedBodyHelper::setZmp(const Vector3& zmp, bool doNotify) {
  if (!getOrCreateZmpDevice()) return;
  zmpDevice_->setZmp(zmp);
  if (doNotify) zmpDevice_->notifyStateChange();
}

}  // namespace cnoid
