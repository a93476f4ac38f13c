// JointPath: the joints between two links, with forward and inverse kinematics.
//
//   auto arm = cnoid::JointPath::getCustomPath(body->rootLink(), body->link("HAND"));
//   if (arm->calcInverseKinematics(goal)) command(body->joint(0)->q(), ...);
//
// It works on the links of the body and moves them. Use a separate copy of the body (body()->clone()) unless that is
// intended. The solution starts from the joints' q and the links' T, which must be consistent: call
// calcForwardKinematics() if q was written since.
//
// Inverse kinematics is damped least squares, one pose at a time: the step is
//   dq = scale * J^T (J J^T + damping² I)^-1 e,   e = (position error [m], rotation vector of the rotation error [rad])
// until |e| is below the tolerance, until it has not decreased for some steps in a row, or until the maximum number of
// steps is reached. Y. Nakamura, H. Hanafusa: Inverse Kinematic Solutions With Singularity Robustness for Robot
// Manipulator Control, 1986.
#pragma once

#include "InverseKinematics.h"
#include "LinkPath.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace cnoid {

class Body;
class NumericalIK;

class CNOID_GENERAL_EXPORT JointPath : public InverseKinematics {
 public:
  using iterator = std::vector<LinkPtr>::iterator;
  using const_iterator = std::vector<LinkPtr>::const_iterator;

  /// The path from base to end. Rehearse has no bodies with custom inverse kinematics, so the result is always a
  /// JointPath itself. Throws std::invalid_argument if a link is null.
  static std::shared_ptr<JointPath> getCustomPath(Link* baseLink, Link* endLink);
  [[deprecated("Use the form without a body.")]] static std::shared_ptr<JointPath> getCustomPath(Body* body,
                                                                                                 Link* baseLink,
                                                                                                 Link* endLink);

  JointPath();
  JointPath(Link* base, Link* end);
  /// Sets the path from the root link to `end`.
  explicit JointPath(Link* end);
  JointPath(const JointPath&) = delete;
  JointPath& operator=(const JointPath&) = delete;
  ~JointPath() override;

  /// False, and an empty path, if no path exists. Settings return to their defaults.
  bool setPath(Link* base, Link* end);

  // --- The joints: revolute and prismatic joints of the path that have a joint id

  bool empty() const { return joints_.empty(); }
  int size() const { return static_cast<int>(joints_.size()); }
  int numJoints() const { return size(); }
  /// 0 to numJoints() - 1; not checked.
  Link* joint(int index) const { return joints_[static_cast<std::size_t>(index)]; }
  Link* operator[](int index) const { return joint(index); }
  const std::vector<LinkPtr>& joints() const { return joints_; }
  iterator begin() { return joints_.begin(); }
  iterator end() { return joints_.end(); }
  const_iterator begin() const { return joints_.begin(); }
  const_iterator end() const { return joints_.end(); }
  /// -1 if the path doesn't contain the joint.
  int indexOf(const Link* link) const;
  /// The path's joints in the order of their ids.
  int jointIndexAtIdOrder(int index) const;
  Link* jointAtIdOrder(int index) const { return joint(jointIndexAtIdOrder(index)); }
  /// True if the path passes the joint from its parent link to its child link.
  bool isJointDownward(int index) const { return index >= numUpwardJoints_; }

  Link* baseLink() const { return linkPath_.baseLink(); }
  Link* endLink() const { return linkPath_.endLink(); }
  LinkPath& linkPath() { return linkPath_; }
  const LinkPath& linkPath() const { return linkPath_; }

  const std::string& name() const { return name_; }
  void setName(const std::string& name) { name_ = name; }

  // --- Kinematics

  void calcForwardKinematics(bool calcVelocity = false, bool calcAcceleration = false) {
    linkPath_.calcForwardKinematics(calcVelocity, calcAcceleration);
  }

  /// Sets the pose of the base link for the next inverse kinematics. The base link is moved there at once.
  JointPath& setBaseLinkGoal(const Isometry3& T);

  using InverseKinematics::calcInverseKinematics;
  /// Moves the path's joints and links so that the end link is at T in the world.
  ///
  /// True: joints and links have reached the goal, and the end link's pose is exactly T (see
  /// setNumericalIkExactEndPositionEnabled). False: q and the end link's pose are unchanged or, with best effort, as
  /// near to the goal as possible. Of the equivalent angles of a revolute joint the one nearest to its start is chosen,
  /// within its limits if it has limits. Otherwise limits are ignored, unless setIkJointLimitEnabled(true) was called.
  /// A path without joints solves only base == end: it moves that link.
  bool calcInverseKinematics(const Isometry3& T) override;

  /// The same for a path with customizeTarget().
  bool calcInverseKinematics();
  /// Replaces the end link's pose by a different task. `errorFunc` writes the remaining error, numTargetElements
  /// numbers, and returns its squared norm; `jacobianFunc` writes numTargetElements x numJoints() derivatives.
  void customizeTarget(int numTargetElements, std::function<double(VectorXd& out_error)> errorFunc,
                       std::function<void(MatrixXd& out_Jacobian)> jacobianFunc);

  /// 6 x numJoints(): velocity of the end link's origin, then its angular velocity, in world axes, relative to the
  /// base.
  void calcJacobian(Eigen::MatrixXd& out_J) const;

  /// The number of steps of the last inverse kinematics.
  int numIterations() const;

  bool hasCustomIK() const { return false; }
  bool isCustomIkDisabled() const { return isCustomIkDisabled_; }
  /// Has no effect.
  void setCustomIkDisabled(bool on) { isCustomIkDisabled_ = on; }

  bool isBestEffortIkAvailable() const override;
  bool isBestEffortIkEnabled() const override;
  void setBestEffortIkEnabled(bool on) override;
  int getDOF() const override;
  /// Computes the poses of all links of the body that are not on the path from the poses of those that are.
  bool calcRemainingPartForwardKinematicsForInverseKinematics() override;

  // --- Tuning

  bool isIkJointLimitEnabled() const { return isIkJointLimitEnabled_; }
  /// In every step, joint displacements are clamped to the joints' limits.
  void setIkJointLimitEnabled(bool on) { isIkJointLimitEnabled_ = on; }
  bool isNumericalIkExactEndPositionEnabled() const { return isExactEndPositionEnabled_; }
  /// Off: the end link's pose is that of forward kinematics, which differs from the goal by up to the tolerance.
  void setNumericalIkExactEndPositionEnabled(bool on) { isExactEndPositionEnabled_ = on; }
  void setNumericalIkMaxIkError(double tolerance);
  void setNumericalIkDeltaScale(double scale);
  void setNumericalIkMaxIterations(int number);
  void setNumericalIkDampingConstant(double damping);
  void setNumericalIkMaxStagnationCount(int number);
  static double numericalIkDefaultMaxIkError() { return 1.0e-7; }
  static double numericalIkDefaultDeltaScale() { return 0.9; }
  static int numericalIkDefaultMaxIterations() { return 50; }
  static double numericalIkDefaultDampingConstant() { return 1.0e-6; }
  static int numericalIkDefaultMaxStagnationCount() { return 3; }

  // Names of earlier releases

  [[deprecated("Use setBaseLinkGoal and calcInverseKinematics(T).")]] bool calcInverseKinematics(const Vector3& base_p,
                                                                                                 const Matrix3& base_R,
                                                                                                 const Vector3& end_p,
                                                                                                 const Matrix3& end_R);
  [[deprecated("Use hasCustomIK.")]] bool hasAnalyticalIK() const { return hasCustomIK(); }
  [[deprecated("Use setCustomIkDisabled.")]] void setNumericalIKenabled(bool on) { setCustomIkDisabled(on); }
  [[deprecated("Use isCustomIkDisabled.")]] bool isNumericalIkEnabled() const { return isCustomIkDisabled(); }
  [[deprecated("Use setNumericalIkMaxIkError.")]] void setNumericalIKmaxIKerror(double e) {
    setNumericalIkMaxIkError(e);
  }
  [[deprecated("Use setNumericalIkDeltaScale.")]] void setNumericalIKdeltaScale(double s) {
    setNumericalIkDeltaScale(s);
  }
  [[deprecated("Use setNumericalIkMaxIterations.")]] void setNumericalIKmaxIterations(int n) {
    setNumericalIkMaxIterations(n);
  }
  [[deprecated("Use setNumericalIkDampingConstant.")]] void setNumericalIKdampingConstant(double lambda) {
    setNumericalIkDampingConstant(lambda);
  }
  [[deprecated("Use setBestEffortIkEnabled.")]] void setBestEffortIKmode(bool on) { setBestEffortIkEnabled(on); }
  [[deprecated("Use isBestEffortIkEnabled.")]] bool isBestEffortIKmode() const { return isBestEffortIkEnabled(); }
  [[deprecated("Use setBestEffortIkEnabled.")]] void setBestEffortIkMode(bool on) { setBestEffortIkEnabled(on); }
  [[deprecated("Use isBestEffortIkEnabled.")]] bool isBestEffortIkMode() const { return isBestEffortIkEnabled(); }

 private:
  void reset();
  void extractJoints();
  void addJoint(Link* link);
  bool moveWithoutJoints(const Isometry3& T);
  bool iterate(const Isometry3* goal);
  double error(const Isometry3* goal);
  void step(bool isCustom);
  void writePoseJacobian();
  void restore();

  LinkPath linkPath_;
  std::vector<LinkPtr> joints_;
  int numUpwardJoints_ = 0;
  std::string name_;
  bool needsForwardKinematics_ = false;
  bool isIkJointLimitEnabled_ = false;
  bool isExactEndPositionEnabled_ = true;
  bool isCustomIkDisabled_ = false;
  std::unique_ptr<NumericalIK> ik_;
};

using JointPathPtr = std::shared_ptr<JointPath>;

[[deprecated("Use JointPath::getCustomPath.")]] inline JointPathPtr getCustomJointPath(Body*, Link* baseLink,
                                                                                       Link* endLink) {
  return JointPath::getCustomPath(baseLink, endLink);
}

}  // namespace cnoid
