// Link: a rigid body of a robot together with the joint that moves it.
//
// In a controller's link, only quantities that were enabled as input on the IO object are refreshed, and only
// quantities of the actuation mode are sent; everything else keeps the value that was last written. In particular T()
// of a moving link is not updated from q() unless LinkPosition is enabled for it.
//
// The link frame is the joint's frame after its motion: T = T(parent) * Tb() * motion(jointAxis(), q()).
//
// Units are SI: [rad] for revolute and [m] for prismatic joints, [N·m] and [N] for their efforts.
#pragma once

#include "ClonableReferenced.h"
#include "EigenTypes.h"
#include "ValueTree.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace cnoid {

class Body;
class Link;
using LinkPtr = ref_ptr<Link>;

class CNOID_GENERAL_EXPORT Link : public ClonableReferenced {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  Link();
  /// Copies everything except its place in a tree (parent, children, body, index) and its contacts.
  Link(const Link& other);
  Link& operator=(const Link&) = delete;
  ~Link() override;
  Link* clone() const { return static_cast<Link*>(doClone(nullptr)); }

  // --- Names and place in the body

  const std::string& name() const { return name_; }
  /// Position in Body::links(); -1 outside a body and for the dummies at unused joint ids.
  int index() const { return index_; }
  bool isValid() const { return index_ >= 0; }
  Body* body() { return body_; }
  const Body* body() const { return body_; }
  Link* parent() const { return parent_; }
  Link* child() const { return child_; }      // the first
  Link* sibling() const { return sibling_; }  // the next child of the same parent
  bool isRoot() const { return !parent_; }
  bool isEndLink() const { return !child_; }
  /// True if no joint between this link and the world can move.
  bool isStatic() const;
  /// True if no joint between this link and the root link can move.
  bool isFixedToRoot() const;
  /// True if `link` is this link or an ancestor of it.
  bool isOwnerOf(const Link* link) const;

  // --- The joint

  enum JointType {
    RevoluteJoint = 0,
    PrismaticJoint = 1,
    FreeJoint = 2,  // a root link that floats
    FixedJoint = 3,
    PseudoContinuousTrackJoint = 4,  // a fixed link whose surface moves

    REVOLUTE_JOINT [[deprecated("Use RevoluteJoint.")]] = RevoluteJoint,
    ROTATIONAL_JOINT [[deprecated("Use RevoluteJoint.")]] = RevoluteJoint,
    PRISMATIC_JOINT [[deprecated("Use PrismaticJoint.")]] = PrismaticJoint,
    SLIDE_JOINT [[deprecated("Use PrismaticJoint.")]] = PrismaticJoint,
    FREE_JOINT [[deprecated("Use FreeJoint.")]] = FreeJoint,
    FIXED_JOINT [[deprecated("Use FixedJoint.")]] = FixedJoint,
    PSEUDO_CONTINUOUS_TRACK [[deprecated("Use PseudoContinuousTrackJoint.")]] = PseudoContinuousTrackJoint
  };

  [[deprecated("Use PseudoContinuousTrackJoint.")]] static constexpr int PseudoContinousTrack =
      PseudoContinuousTrackJoint;

  JointType jointType() const { return jointType_; }
  /// "revolute", "prismatic", "free", "fixed" or "pseudo continuous track".
  const char* jointTypeLabel() const;
  /// The same names, with underscores instead of spaces.
  const char* jointTypeSymbol() const;
  bool isRevoluteJoint() const { return jointType_ == RevoluteJoint; }
  bool isPrismaticJoint() const { return jointType_ == PrismaticJoint; }
  bool isFreeJoint() const { return jointType_ == FreeJoint; }
  /// True for a pseudo continuous track, too.
  bool isFixedJoint() const { return jointType_ >= FixedJoint; }
  /// True for revolute and prismatic joints.
  bool hasActualJoint() const { return jointType_ <= PrismaticJoint; }
  [[deprecated("Use jointTypeLabel or jointTypeSymbol.")]] const char* jointTypeString(
      bool useUnderscore = false) const {
    return useUnderscore ? jointTypeSymbol() : jointTypeLabel();
  }
  [[deprecated("Use isRevoluteJoint.")]] bool isRotationalJoint() const { return isRevoluteJoint(); }
  [[deprecated("Use isPrismaticJoint.")]] bool isSlideJoint() const { return isPrismaticJoint(); }
  [[deprecated("Use hasActualJoint.")]] bool hasJoint() const { return hasActualJoint(); }

  /// -1 if the joint has no id.
  int jointId() const { return jointId_; }
  /// The joint's name, or the link's name if the joint has none.
  const std::string& jointName() const { return jointSpecificName_.empty() ? name_ : jointSpecificName_; }
  const std::string& jointSpecificName() const { return jointSpecificName_; }

  /// Unit vector in the link frame.
  const Vector3& a() const { return a_; }
  const Vector3& d() const { return a_; }
  const Vector3& jointAxis() const { return a_; }

  /// Pose of this link's frame in its parent's frame at q = 0.
  const Isometry3& Tb() const { return Tb_; }
  const Isometry3& offsetPosition() const { return Tb_; }
  Isometry3::ConstTranslationPart b() const { return Tb_.translation(); }
  Isometry3::ConstTranslationPart offsetTranslation() const { return Tb_.translation(); }
  Isometry3::ConstLinearPart Rb() const { return Tb_.linear(); }
  Isometry3::ConstLinearPart offsetRotation() const { return Tb_.linear(); }

  // --- Input and output quantities

  enum StateFlag {
    StateNone = 0,
    JointDisplacement = 1 << 0,  // in: q()      out: q_target()
    JointAngle = JointDisplacement,
    JointVelocity = 1 << 1,      // in: dq()     out: dq_target()
    JointAcceleration = 1 << 2,  // in: ddq()    out: ddq()
    JointEffort = 1 << 3,        // in: u()      out: u()
    JointForce = JointEffort,
    JointTorque = JointEffort,
    LinkPosition = 1 << 4,      // in: T()      out: T()
    LinkTwist = 1 << 5,         // in: v(), w()    out: the same
    LinkAcceleration = 1 << 6,  // in: dv(), dw()  out: the same
    LinkExtWrench = 1 << 7,     // in: F_ext()  out: F_ext(), added to other external forces
    LinkContactState = 1 << 8,  // in: contactPoints()

    HighGainActuation = 1 << 9,  // an option of other simulators
    DeprecatedJointSurfaceVelocity = 1 << 10,

    MaxStateTypeBit = 10,
    NumStateTypes = 11,

    NO_ACTUATION [[deprecated("Use StateNone.")]] = StateNone,
    JOINT_TORQUE [[deprecated("Use JointTorque.")]] = JointTorque,
    JOINT_FORCE [[deprecated("Use JointForce.")]] = JointForce,
    JOINT_EFFORT [[deprecated("Use JointEffort.")]] = JointEffort,
    JOINT_ANGLE [[deprecated("Use JointAngle.")]] = JointAngle,
    JOINT_DISPLACEMENT [[deprecated("Use JointDisplacement.")]] = JointDisplacement,
    JOINT_VELOCITY [[deprecated("Use JointVelocity.")]] = JointVelocity,
    LINK_POSITION [[deprecated("Use LinkPosition.")]] = LinkPosition
  };
  [[deprecated("Use JointVelocity on a PseudoContinuousTrackJoint.")]] static constexpr int JOINT_SURFACE_VELOCITY =
      DeprecatedJointSurfaceVelocity;
  /// Choreonoid's mode for contact forces alone, which no item drives here.
  static constexpr short AllStateHighGainActuationMode =
      LinkPosition | LinkTwist | LinkExtWrench | JointDisplacement | JointVelocity | JointEffort | HighGainActuation;
  /// "Joint Displacement + Joint Velocity", or "None".
  static std::string getStateModeString(short mode);

  using ActuationMode [[deprecated("Use StateFlag, or int for several flags.")]] = StateFlag;

  /// The quantities that drive the joint: StateFlags, usually one. They determine the effect of enableInput(link) and
  /// enableOutput(link).
  short actuationMode() const { return actuationMode_; }
  void setActuationMode(short mode) { actuationMode_ = mode; }

  /// The quantities that are read from the link: StateFlags. The IO object's enableInput adds to them.
  short sensingMode() const { return sensingMode_; }
  void setSensingMode(short mode) { sensingMode_ = mode; }
  void mergeSensingMode(short mode) { sensingMode_ = static_cast<short>(sensingMode_ | mode); }

  // --- State of the joint

  double q() const {
    noteAccess(JointDisplacement);
    return q_;
  }
  double& q() {
    noteAccess(JointDisplacement);
    return q_;
  }
  double dq() const {
    noteAccess(JointVelocity);
    return dq_;
  }
  double& dq() {
    noteAccess(JointVelocity);
    return dq_;
  }
  double ddq() const { return ddq_; }
  double& ddq() { return ddq_; }
  /// Torque or force of the actuator.
  double u() const { return u_; }
  double& u() { return u_; }
  /// Commands.
  double q_target() const { return q_target_; }
  double& q_target() { return q_target_; }
  double dq_target() const { return dq_target_; }
  double& dq_target() { return dq_target_; }

  /// Sets dq = ddq = u = 0, targets to the joint's displacement, no motion, no external force. q and T stay.
  void initializeState();

  // --- Limits

  double q_initial() const { return q_initial_; }
  double q_upper() const { return q_upper_; }
  double q_lower() const { return q_lower_; }
  double dq_upper() const { return dq_upper_; }
  double dq_lower() const { return dq_lower_; }
  double u_upper() const { return u_upper_; }
  double u_lower() const { return u_lower_; }

  [[deprecated("Use q_upper.")]] const double& ulimit() const { return q_upper_; }
  [[deprecated("Use q_lower.")]] const double& llimit() const { return q_lower_; }
  [[deprecated("Use dq_upper.")]] const double& uvlimit() const { return dq_upper_; }
  [[deprecated("Use dq_lower.")]] const double& lvlimit() const { return dq_lower_; }

  /// "No limit" is plus or minus the largest double.
  static bool isUnlimitedRangeValue(double value) { return std::abs(value) >= std::numeric_limits<double>::max(); }
  /// True if there is a limit in both directions.
  bool hasJointDisplacementLimits() const;
  bool hasJointVelocityLimits() const;
  bool hasJointEffortLimits() const;
  void setUnlimitedJointDisplacementRange();
  void setUnlimitedJointVelocityRange();
  void setUnlimitedEffortRange();

  // --- Pose of the link frame in the world

  Isometry3& T() { return T_; }
  const Isometry3& T() const { return T_; }
  Isometry3& position() { return T_; }
  const Isometry3& position() const { return T_; }
  Isometry3::TranslationPart p() { return T_.translation(); }
  Isometry3::ConstTranslationPart p() const { return T_.translation(); }
  Isometry3::TranslationPart translation() { return T_.translation(); }
  Isometry3::ConstTranslationPart translation() const { return T_.translation(); }
  Isometry3::LinearPart R() { return T_.linear(); }
  Isometry3::ConstLinearPart R() const { return T_.linear(); }
  Isometry3::LinearPart rotation() { return T_.linear(); }
  Isometry3::ConstLinearPart rotation() const { return T_.linear(); }

  template <class Scalar, int Mode, int Options>
  void setPosition(const Eigen::Transform<Scalar, 3, Mode, Options>& pose) {
    T_ = pose.template cast<double>();
  }
  /// Sets the pose from a 4x4 or 3x4 matrix.
  template <class Derived>
  void setPosition(const Eigen::MatrixBase<Derived>& pose) {
    T_.matrix().template topRows<3>() = pose.template topRows<3>().template cast<double>();
  }
  template <typename Derived1, typename Derived2>
  void setPosition(const Eigen::MatrixBase<Derived1>& newRotation, const Eigen::MatrixBase<Derived2>& newTranslation) {
    setRotation(newRotation);
    setTranslation(newTranslation);
  }
  template <typename Derived>
  void setTranslation(const Eigen::MatrixBase<Derived>& newTranslation) {
    T_.translation() = newTranslation.template cast<double>();
  }
  template <typename Derived>
  void setRotation(const Eigen::MatrixBase<Derived>& newRotation) {
    T_.linear() = newRotation.template cast<double>();
  }
  template <typename Scalar>
  void setRotation(const Eigen::AngleAxis<Scalar>& newRotation) {
    T_.linear() = newRotation.template cast<double>().toRotationMatrix();
  }
  template <typename Derived>
  void setRotation(const Eigen::QuaternionBase<Derived>& newRotation) {
    T_.linear() = newRotation.template cast<double>().toRotationMatrix();
  }

  // Names of earlier releases, in which a link's axes could differ from those of its model

  [[deprecated("Use T.")]] Isometry3 Ta() const { return T_; }
  [[deprecated("It is the identity.")]] Matrix3 Rs() const { return Matrix3::Identity(); }
  [[deprecated("Use R.")]] Matrix3 attitude() const { return R(); }
  [[deprecated("Use setRotation.")]] void setAttitude(const Matrix3& newRotation) { R() = newRotation; }
  [[deprecated("Use the matrix itself.")]] Matrix3 calcRfromAttitude(const Matrix3& rotation) const { return rotation; }
  [[deprecated("Use T.")]] void getAttitudeAndTranslation(Isometry3& pose) const { pose = T_; }

  // --- Motion of the link frame's origin, in world axes

  Vector3& v() { return v_; }  // [m/s]
  const Vector3& v() const { return v_; }
  Vector3& w() { return w_; }  // [rad/s]
  const Vector3& w() const { return w_; }
  Vector3& dv() { return dv_; }  // [m/s²]
  const Vector3& dv() const { return dv_; }
  Vector3& dw() { return dw_; }  // [rad/s²]
  const Vector3& dw() const { return dw_; }

  // --- Mass

  double m() const { return m_; }  // [kg]
  double mass() const { return m_; }
  /// Centre of mass in the link frame [m].
  const Vector3& c() const { return c_; }
  const Vector3& centerOfMass() const { return c_; }
  /// Centre of mass in the world [m], as computed by the last Body::calcCenterOfMass().
  Vector3& wc() { return wc_; }
  const Vector3& wc() const { return wc_; }
  const Vector3& centerOfMassGlobal() const { return wc_; }
  /// Inertia about the centre of mass, along the link's axes [kg·m²].
  const Matrix3& I() const { return I_; }
  /// Rotor inertia at the joint [kg·m²].
  double Jm2() const { return Jm2_; }

  // --- External force: world axes, torque about the world's origin [N, N·m]

  Vector6& F_ext() { return F_ext_; }
  const Vector6& F_ext() const { return F_ext_; }
  Vector6& externalWrench() { return F_ext_; }
  const Vector6& externalWrench() const { return F_ext_; }
  Vector6::FixedSegmentReturnType<3>::Type f_ext() { return F_ext_.head<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type f_ext() const { return F_ext_.head<3>(); }
  Vector6::FixedSegmentReturnType<3>::Type externalForce() { return F_ext_.head<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type externalForce() const { return F_ext_.head<3>(); }
  Vector6::FixedSegmentReturnType<3>::Type tau_ext() { return F_ext_.tail<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type tau_ext() const { return F_ext_.tail<3>(); }
  Vector6::FixedSegmentReturnType<3>::Type externalTorque() { return F_ext_.tail<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type externalTorque() const { return F_ext_.tail<3>(); }

  /// Adds a force (world axes) that acts at a point of this link. Uses T().
  void addExternalForceAtLocalPosition(const Vector3& force, const Vector3& localPosition) {
    addExternalForceAtGlobalPosition(force, T_ * localPosition);
  }
  void addExternalForceAtGlobalPosition(const Vector3& force, const Vector3& globalPosition) {
    f_ext() += force;
    tau_ext() += globalPosition.cross(force);
  }
  [[deprecated("Use addExternalForceAtLocalPosition.")]] void addExternalForce(const Vector3& force,
                                                                               const Vector3& localPosition) {
    addExternalForceAtLocalPosition(force, localPosition);
  }

  // --- Contacts

  /// Of the link's surface, as the model names it: "Default" if it names none.
  const std::string& materialName() const { return material_; }
  /// The same for two links whose materials have one name, whatever their bodies; 0 for "Default". Not Choreonoid's
  /// number, which depends on what was loaded before.
  int materialId() const;

  /// A point where a different object touches this link; everything in world axes.
  class ContactPoint {
   public:
    ContactPoint(const Vector3& position, const Vector3& normal, const Vector3& force, const Vector3& velocity,
                 double depth)
        : position_(position), normal_(normal), force_(force), velocity_(velocity), depth_(depth) {}
    const Vector3& position() const { return position_; }  // [m]
    const Vector3& normal() const { return normal_; }      // unit vector, from the other object to this link
    const Vector3& force() const { return force_; }        // of the other object on this link [N]
    const Vector3& velocity() const { return velocity_; }  // of this link relative to the other [m/s]
    double depth() const { return depth_; }                // [m]

   private:
    Vector3 position_;
    Vector3 normal_;
    Vector3 force_;
    Vector3 velocity_;
    double depth_;
  };
  std::vector<ContactPoint>& contactPoints() { return contactPoints_; }
  const std::vector<ContactPoint>& contactPoints() const { return contactPoints_; }

  // --- Additional information in the model

  /// Never null.
  Mapping* info() { return info_; }
  const Mapping* info() const { return info_; }
  /// Throws ValueNode::KeyNotFoundException if there is no value of that key and type.
  template <typename T>
  T info(const std::string& key) const {
    return info_->get<T>(key);
  }
  template <typename T>
  T info(const std::string& key, const T& defaultValue) const {
    return info_->get(key, defaultValue);
  }
  std::string info(const std::string& key, const char* defaultValue) const { return info_->get(key, defaultValue); }
  template <typename T>
  void setInfo(const std::string& key, const T& value) {
    info_->write(key, value);
  }
  void resetInfo(Mapping* newInfo) { info_ = newInfo; }

  // --- For building a body. After changes to tree, names or joint ids: Body::updateLinkTree().

  void setName(const std::string& newName) { name_ = newName; }
  void setJointName(const std::string& newName) { jointSpecificName_ = newName; }
  void setJointId(int id) { jointId_ = id; }
  void setJointType(JointType type) { jointType_ = type; }
  void setJointAxis(const Vector3& axis) { a_ = axis; }
  void setInitialJointDisplacement(double displacement) { q_initial_ = displacement; }
  void setInitialJointAngle(double angle) { q_initial_ = angle; }
  void setJointRange(double lower, double upper) {
    q_lower_ = lower;
    q_upper_ = upper;
  }
  void setJointVelocityRange(double lower, double upper) {
    dq_lower_ = lower;
    dq_upper_ = upper;
  }
  void setJointEffortRange(double lower, double upper) {
    u_lower_ = lower;
    u_upper_ = upper;
  }
  void setOffsetPosition(const Isometry3& offset) { Tb_ = offset; }
  template <typename Derived>
  void setOffsetTranslation(const Eigen::MatrixBase<Derived>& offset) {
    Tb_.translation() = offset.template cast<double>();
  }
  template <typename Derived>
  void setOffsetRotation(const Eigen::MatrixBase<Derived>& offset) {
    Tb_.linear() = offset.template cast<double>();
  }
  template <typename Scalar>
  void setOffsetRotation(const Eigen::AngleAxis<Scalar>& offset) {
    Tb_.linear() = offset.template cast<double>().toRotationMatrix();
  }
  void setMass(double newMass) { m_ = newMass; }
  void setCenterOfMass(const Vector3& center) { c_ = center; }
  void setInertia(const Matrix3& inertia) { I_ = inertia; }
  void setEquivalentRotorInertia(double inertia) { Jm2_ = inertia; }
  /// An empty name means "Default".
  void setMaterial(const std::string& name) { material_ = name.empty() ? "Default" : name; }

  /// Moves the link, with all links below it, from its place and makes it the last, or first, child of this link.
  void appendChild(Link* link);
  void prependChild(Link* link);
  /// Removes a child link with all links below it; their devices leave the body. False if it is no child of this link.
  bool removeChild(Link* link);

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  friend class Body;
  friend struct AccessedStates;  // of Rehearse's host
  /// Notes a call of q() (JointDisplacement) or dq() (JointVelocity). Threads may call both at once: a flag that one of
  /// them overwrites is set by the next call.
  void noteAccess(short flag) const {
    const short noted = __atomic_load_n(&accessedStates_, __ATOMIC_RELAXED);
    if (!(noted & flag)) __atomic_store_n(&accessedStates_, static_cast<short>(noted | flag), __ATOMIC_RELAXED);
  }
  void takeFromParent();
  void setBodyToSubTree(Body* body);

  std::string name_;
  std::string jointSpecificName_;
  int index_ = -1;
  int jointId_ = -1;
  Link* parent_ = nullptr;
  LinkPtr child_;
  LinkPtr sibling_;
  Body* body_ = nullptr;
  JointType jointType_ = FixedJoint;
  short actuationMode_ = StateNone;
  short sensingMode_ = StateNone;

  Isometry3 T_;
  Isometry3 Tb_;
  Vector3 a_;
  double q_ = 0.0;
  double dq_ = 0.0;
  double ddq_ = 0.0;
  double u_ = 0.0;
  double q_target_ = 0.0;
  double dq_target_ = 0.0;
  Vector3 v_;
  Vector3 w_;
  Vector3 dv_;
  Vector3 dw_;
  mutable short accessedStates_ = StateNone;  // in padding: libraries built with older headers have the same layout
  Vector6 F_ext_;

  double m_ = 1.0;
  Vector3 c_;
  Vector3 wc_;
  Matrix3 I_;
  double Jm2_ = 0.0;
  double q_initial_ = 0.0;
  double q_upper_;
  double q_lower_;
  double dq_upper_;
  double dq_lower_;
  double u_upper_;
  double u_lower_;
  std::string material_ = "Default";
  std::vector<ContactPoint> contactPoints_;
  MappingPtr info_;
};

}  // namespace cnoid
