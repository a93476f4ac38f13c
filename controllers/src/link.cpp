#include <cnoid/Link>

#include <cnoid/Body>
#include <cstdint>

namespace cnoid {

Link::Link()
    : T_(Isometry3::Identity()),
      Tb_(Isometry3::Identity()),
      a_(Vector3::UnitZ()),
      v_(Vector3::Zero()),
      w_(Vector3::Zero()),
      dv_(Vector3::Zero()),
      dw_(Vector3::Zero()),
      F_ext_(Vector6::Zero()),
      c_(Vector3::Zero()),
      wc_(Vector3::Zero()),
      I_(Matrix3::Identity()),
      info_(new Mapping) {
  setUnlimitedJointDisplacementRange();
  setUnlimitedJointVelocityRange();
  setUnlimitedEffortRange();
}

Link::Link(const Link& other)
    : ClonableReferenced(other),
      name_(other.name_),
      jointSpecificName_(other.jointSpecificName_),
      jointId_(other.jointId_),
      jointType_(other.jointType_),
      actuationMode_(other.actuationMode_),
      sensingMode_(other.sensingMode_),
      T_(other.T_),
      Tb_(other.Tb_),
      a_(other.a_),
      q_(other.q_),
      dq_(other.dq_),
      ddq_(other.ddq_),
      u_(other.u_),
      q_target_(other.q_target_),
      dq_target_(other.dq_target_),
      v_(other.v_),
      w_(other.w_),
      dv_(other.dv_),
      dw_(other.dw_),
      F_ext_(other.F_ext_),
      m_(other.m_),
      c_(other.c_),
      wc_(other.wc_),
      I_(other.I_),
      Jm2_(other.Jm2_),
      q_initial_(other.q_initial_),
      q_upper_(other.q_upper_),
      q_lower_(other.q_lower_),
      dq_upper_(other.dq_upper_),
      dq_lower_(other.dq_lower_),
      u_upper_(other.u_upper_),
      u_lower_(other.u_lower_),
      material_(other.material_),
      info_(other.info_->deepClone()) {}

Link::~Link() {
  // A child that has other owners must not keep pointers to this link or to its former siblings. Removing the children
  // one by one also prevents a recursive deletion of a long row of siblings.
  LinkPtr child = std::move(child_);
  while (child) {
    LinkPtr next = std::move(child->sibling_);
    child->parent_ = nullptr;
    child->setBodyToSubTree(nullptr);
    child = std::move(next);
  }
}

Referenced* Link::doClone(CloneMap*) const { return new Link(*this); }

bool Link::isStatic() const {
  for (const Link* link = this; link; link = link->parent_) {
    if (!link->isFixedJoint()) return false;
  }
  return true;
}

bool Link::isFixedToRoot() const {
  for (const Link* link = this; !link->isRoot(); link = link->parent_) {
    if (!link->isFixedJoint()) return false;
  }
  return true;
}

bool Link::isOwnerOf(const Link* link) const {
  for (const Link* carrier = this; carrier; carrier = carrier->parent_) {
    if (carrier == link) return true;
  }
  return false;
}

const char* Link::jointTypeLabel() const {
  return jointType_ == PseudoContinuousTrackJoint ? "pseudo continuous track" : jointTypeSymbol();
}

const char* Link::jointTypeSymbol() const {
  switch (jointType_) {
    case RevoluteJoint: return "revolute";
    case PrismaticJoint: return "prismatic";
    case FreeJoint: return "free";
    case FixedJoint: return "fixed";
    case PseudoContinuousTrackJoint: return "pseudo_continuous_track";
  }
  return "unknown";
}

std::string Link::getStateModeString(short mode) {
  struct Name {
    int flag;
    const char* text;
  };
  constexpr Name names[] = {{JointDisplacement, "Joint Displacement"},
                            {JointVelocity, "Joint Velocity"},
                            {JointAcceleration, "Joint Acceleration"},
                            {JointEffort, "Joint Effort"},
                            {LinkPosition, "Link Position"},
                            {LinkTwist, "Link Twist"},
                            {LinkAcceleration, ""},  // Choreonoid has no names for these two
                            {LinkExtWrench, "Link External Wrench"},
                            {LinkContactState, "Link Contact State"},
                            {HighGainActuation, ""},
                            {DeprecatedJointSurfaceVelocity, "Joint Surface Velocity"}};
  std::string text;
  for (const Name& name : names)
    if (mode & name.flag) text += (text.empty() ? "" : " + ") + std::string(name.text);
  return mode == StateNone ? "None" : text;
}

int Link::materialId() const {
  if (material_ == "Default") return 0;
  std::uint32_t hash = 2166136261U;  // FNV-1a
  for (const char letter : material_) hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619U;
  return static_cast<int>(hash >> 1 | 1U);
}

void Link::initializeState() {
  dq_ = 0.0;
  ddq_ = 0.0;
  u_ = 0.0;
  q_target_ = q_;
  dq_target_ = 0.0;
  v_.setZero();
  w_.setZero();
  dv_.setZero();
  dw_.setZero();
  F_ext_.setZero();
}

bool Link::hasJointDisplacementLimits() const {
  return !isUnlimitedRangeValue(q_lower_) && !isUnlimitedRangeValue(q_upper_);
}

bool Link::hasJointVelocityLimits() const {
  return !isUnlimitedRangeValue(dq_lower_) && !isUnlimitedRangeValue(dq_upper_);
}

bool Link::hasJointEffortLimits() const { return !isUnlimitedRangeValue(u_lower_) && !isUnlimitedRangeValue(u_upper_); }

void Link::setUnlimitedJointDisplacementRange() {
  setJointRange(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

void Link::setUnlimitedJointVelocityRange() {
  setJointVelocityRange(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

void Link::setUnlimitedEffortRange() {
  setJointEffortRange(std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max());
}

void Link::takeFromParent() {
  if (parent_) parent_->removeChild(this);
}

void Link::appendChild(Link* link) {
  const LinkPtr holder(link);  // its old parent may have been its only owner
  link->takeFromParent();
  LinkPtr* last = &child_;
  while (*last) last = &(*last)->sibling_;
  *last = link;
  link->parent_ = this;
  link->setBodyToSubTree(body_);
}

void Link::prependChild(Link* link) {
  const LinkPtr holder(link);
  link->takeFromParent();
  link->sibling_ = child_;
  child_ = link;
  link->parent_ = this;
  link->setBodyToSubTree(body_);
}

bool Link::removeChild(Link* link) {
  for (LinkPtr* place = &child_; *place; place = &(*place)->sibling_) {
    if (*place != link) continue;
    const LinkPtr holder(link);
    *place = link->sibling_;
    link->sibling_ = nullptr;
    link->parent_ = nullptr;
    link->setBodyToSubTree(nullptr);
    return true;
  }
  return false;
}

void Link::setBodyToSubTree(Body* body) {
  if (body_ == body) return;
  if (body_) body_->removeDevicesOfLink(this);
  body_ = body;
  for (Link* child = child_; child; child = child->sibling_) child->setBodyToSubTree(body);
}

}  // namespace cnoid
