#include <algorithm>
#include <cmath>
#include <cnoid/EigenUtil>
#include <cnoid/JointPath>
#include <limits>
#include <stdexcept>

#include "id_order.h"
#include "remaining_links.h"

namespace cnoid {

/// Settings and workspace. The pose task has fixed sizes, so that a solution allocates nothing.
class NumericalIK {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  double maxError = JointPath::numericalIkDefaultMaxIkError();
  double scale = JointPath::numericalIkDefaultDeltaScale();
  int maxIterations = JointPath::numericalIkDefaultMaxIterations();
  double damping = JointPath::numericalIkDefaultDampingConstant();
  int maxStagnation = JointPath::numericalIkDefaultMaxStagnationCount();
  bool isBestEffort = false;
  int iteration = 0;

  std::function<double(VectorXd&)> errorFunc;
  std::function<void(MatrixXd&)> jacobianFunc;
  VectorXd customError;
  MatrixXd customJacobian;

  Vector6 poseError;
  Eigen::Matrix<double, 6, Eigen::Dynamic> poseJacobian;
  VectorXd q_start;
  VectorXd q_best;
  VectorXd dq;
  Isometry3 T_start;
};

namespace {

/// dq = J^T (J J^T + damping² I)^-1 e
template <class Jacobian, class Error>
void solveDamped(const Jacobian& J, const Error& e, double damping, VectorXd& dq) {
  using Square = Eigen::Matrix<double, Jacobian::RowsAtCompileTime, Jacobian::RowsAtCompileTime>;
  Square A(J.rows(), J.rows());
  A.noalias() = J.lazyProduct(J.transpose());
  A.diagonal().array() += damping * damping;
  const Error x = Eigen::LDLT<Square>(A).solve(e);
  dq.noalias() = J.transpose().lazyProduct(x);
}

/// The displacement; for a revolute joint the equivalent angle nearest to its start, within its limits if one of the
/// equivalent angles is.
double nearestPhase(const Link& joint, double q, double q_start) {
  if (!joint.isRevoluteJoint()) return q;
  constexpr double turn = 2.0 * PI;
  const double nearest = q + turn * std::round((q_start - q) / turn);
  if (nearest < joint.q_lower()) {
    const double lowest = nearest + turn * std::ceil((joint.q_lower() - nearest) / turn);
    return lowest <= joint.q_upper() ? lowest : nearest;
  }
  if (nearest > joint.q_upper()) {
    const double highest = nearest - turn * std::ceil((nearest - joint.q_upper()) / turn);
    return highest >= joint.q_lower() ? highest : nearest;
  }
  return nearest;
}

}  // namespace

// --- InverseKinematics

InverseKinematics::~InverseKinematics() = default;

bool InverseKinematics::calcInverseKinematics(const Vector3& p, const Matrix3& R) {
  Isometry3 T = Isometry3::Identity();
  T.translation() = p;
  T.linear() = R;
  return calcInverseKinematics(T);
}

bool InverseKinematics::calcRemainingPartForwardKinematicsForInverseKinematics() { return false; }

bool InverseKinematics::isBestEffortIkAvailable() const { return false; }

bool InverseKinematics::isBestEffortIkEnabled() const { return false; }

void InverseKinematics::setBestEffortIkEnabled(bool) {}

int InverseKinematics::getDOF() const { return 0; }

// --- The path

std::shared_ptr<JointPath> JointPath::getCustomPath(Link* baseLink, Link* endLink) {
  return std::make_shared<JointPath>(baseLink, endLink);
}

std::shared_ptr<JointPath> JointPath::getCustomPath(Body*, Link* baseLink, Link* endLink) {
  return getCustomPath(baseLink, endLink);
}

JointPath::JointPath() : ik_(std::make_unique<NumericalIK>()) {}

JointPath::JointPath(Link* base, Link* end) : linkPath_(base, end), ik_(std::make_unique<NumericalIK>()) {
  extractJoints();
}

JointPath::JointPath(Link* end) : linkPath_(end), ik_(std::make_unique<NumericalIK>()) { extractJoints(); }

JointPath::~JointPath() = default;

bool JointPath::setPath(Link* base, Link* end) {
  const bool found = linkPath_.setPath(base, end);
  reset();
  extractJoints();
  return found;
}

void JointPath::reset() {
  needsForwardKinematics_ = false;
  isIkJointLimitEnabled_ = false;
  isExactEndPositionEnabled_ = true;
  isCustomIkDisabled_ = false;
  ik_ = std::make_unique<NumericalIK>();
}

void JointPath::extractJoints() {
  // A link's joint connects it to its parent: on the way up the path uses the joint of the link that it leaves, on the
  // way down that of the link that it reaches. The joint above the topmost link is not part of the path.
  joints_.clear();
  int index = 0;
  for (; index + 1 < linkPath_.numLinks() && !linkPath_.isDownward(index); ++index) addJoint(linkPath_[index]);
  numUpwardJoints_ = numJoints();
  for (++index; index < linkPath_.numLinks(); ++index) addJoint(linkPath_[index]);
}

void JointPath::addJoint(Link* link) {
  if (link->jointId() >= 0 && link->hasActualJoint()) joints_.push_back(link);
}

int JointPath::indexOf(const Link* link) const {
  const auto place =
      std::find_if(joints_.begin(), joints_.end(), [link](const LinkPtr& joint) { return joint == link; });
  return place == joints_.end() ? -1 : static_cast<int>(place - joints_.begin());
}

int JointPath::jointIndexAtIdOrder(int index) const { return placeInIdOrder(joints_, index); }

// --- Inverse kinematics

JointPath& JointPath::setBaseLinkGoal(const Isometry3& T) {
  if (Link* base = baseLink()) base->setPosition(T);
  needsForwardKinematics_ = true;
  return *this;
}

bool JointPath::calcInverseKinematics(const Isometry3& T) {
  if (joints_.empty()) return moveWithoutJoints(T);
  const Isometry3 goal = T;  // a copy, because T may refer to the pose of a link that moves
  if (!iterate(&goal)) return false;
  if (isExactEndPositionEnabled_) endLink()->T() = goal;
  return true;
}

bool JointPath::calcInverseKinematics() { return ik_->errorFunc && !joints_.empty() && iterate(nullptr); }

bool JointPath::calcInverseKinematics(const Vector3& base_p, const Matrix3& base_R, const Vector3& end_p,
                                      const Matrix3& end_R) {
  Isometry3 base = Isometry3::Identity();
  base.translation() = base_p;
  base.linear() = base_R;
  Isometry3 end = Isometry3::Identity();
  end.translation() = end_p;
  end.linear() = end_R;
  return setBaseLinkGoal(base).calcInverseKinematics(end);
}

bool JointPath::moveWithoutJoints(const Isometry3& T) {
  if (linkPath_.empty() || baseLink() != endLink()) return false;
  endLink()->setPosition(T);
  return true;
}

bool JointPath::iterate(const Isometry3* goal) {
  NumericalIK& ik = *ik_;
  if (needsForwardKinematics_) calcForwardKinematics();
  needsForwardKinematics_ = false;
  ik.q_start.resize(numJoints());
  for (int i = 0; i < numJoints(); ++i) ik.q_start[i] = joint(i)->q();
  ik.T_start = endLink()->T();
  ik.dq.resize(numJoints());

  const double maxErrorSqr = ik.maxError * ik.maxError;
  double lastErrorSqr = std::numeric_limits<double>::max();
  double leastErrorSqr = lastErrorSqr;
  int stagnation = 0;
  if (ik.isBestEffort) ik.q_best = ik.q_start;
  for (ik.iteration = 0; ik.iteration < ik.maxIterations; ++ik.iteration) {
    const double errorSqr = error(goal);
    const bool isBest = errorSqr < leastErrorSqr;
    if (isBest) leastErrorSqr = errorSqr;
    if (isBest && ik.isBestEffort) {
      for (int i = 0; i < numJoints(); ++i) ik.q_best[i] = joint(i)->q();
    }
    if (errorSqr < maxErrorSqr) return true;
    const bool isProgress = ik.isBestEffort ? isBest : lastErrorSqr - errorSqr >= maxErrorSqr;
    stagnation = isProgress ? 0 : stagnation + 1;
    if (stagnation >= ik.maxStagnation) break;
    lastErrorSqr = errorSqr;
    step(!!ik.errorFunc);
  }
  restore();
  return false;
}

double JointPath::error(const Isometry3* goal) {
  NumericalIK& ik = *ik_;
  if (ik.errorFunc) return ik.errorFunc(ik.customError);
  const Isometry3& T = endLink()->T();
  ik.poseError.head<3>() = goal->translation() - T.translation();
  ik.poseError.tail<3>() = T.linear() * omegaFromRot(T.linear().transpose() * goal->linear());
  return ik.poseError.squaredNorm();
}

void JointPath::step(bool isCustom) {
  NumericalIK& ik = *ik_;
  if (isCustom) {
    ik.jacobianFunc(ik.customJacobian);
    solveDamped(ik.customJacobian, ik.customError, ik.damping, ik.dq);
  } else {
    writePoseJacobian();
    solveDamped(ik.poseJacobian, ik.poseError, ik.damping, ik.dq);
  }
  for (int i = 0; i < numJoints(); ++i) {
    Link& moved = *joint(i);
    moved.q() = nearestPhase(moved, moved.q() + ik.scale * ik.dq[i], ik.q_start[i]);
    if (isIkJointLimitEnabled_) moved.q() = std::max(std::min(moved.q(), moved.q_upper()), moved.q_lower());
  }
  calcForwardKinematics();
}

void JointPath::writePoseJacobian() {
  auto& J = ik_->poseJacobian;
  J.resize(6, numJoints());
  const Vector3 end = endLink()->p();
  for (int i = 0; i < numJoints(); ++i) {
    const Link& link = *joint(i);
    // If the path climbs through a joint, the links behind it move in the opposite direction.
    const Vector3 axis = (isJointDownward(i) ? 1.0 : -1.0) * (link.R() * link.a());
    if (link.isRevoluteJoint()) {
      J.col(i) << axis.cross(end - link.p()), axis;
    } else {
      J.col(i) << axis, Vector3::Zero();
    }
  }
}

void JointPath::restore() {
  const NumericalIK& ik = *ik_;
  const VectorXd& q = ik.isBestEffort ? ik.q_best : ik.q_start;
  for (int i = 0; i < numJoints(); ++i) joint(i)->q() = q[i];
  calcForwardKinematics();
  if (!ik.isBestEffort) endLink()->T() = ik.T_start;
}

void JointPath::calcJacobian(Eigen::MatrixXd& out_J) const {
  const_cast<JointPath*>(this)->writePoseJacobian();  // writes a workspace only, no state
  out_J = ik_->poseJacobian;
}

void JointPath::customizeTarget(int numTargetElements, std::function<double(VectorXd&)> errorFunc,
                                std::function<void(MatrixXd&)> jacobianFunc) {
  if (!errorFunc || !jacobianFunc) throw std::invalid_argument("customizeTarget: a function is missing");
  ik_->customError.resize(numTargetElements);
  ik_->customJacobian.resize(numTargetElements, numJoints());
  ik_->errorFunc = std::move(errorFunc);
  ik_->jacobianFunc = std::move(jacobianFunc);
}

int JointPath::numIterations() const { return ik_->iteration; }

bool JointPath::isBestEffortIkAvailable() const { return true; }

bool JointPath::isBestEffortIkEnabled() const { return ik_->isBestEffort; }

void JointPath::setBestEffortIkEnabled(bool on) { ik_->isBestEffort = on; }

bool JointPath::calcRemainingPartForwardKinematicsForInverseKinematics() {
  if (linkPath_.empty()) return false;
  calcRemainingForwardKinematics(*endLink(), {&linkPath_});
  return true;
}

int JointPath::getDOF() const { return numJoints(); }

void JointPath::setNumericalIkMaxIkError(double tolerance) { ik_->maxError = tolerance; }

void JointPath::setNumericalIkDeltaScale(double scale) { ik_->scale = scale; }

void JointPath::setNumericalIkMaxIterations(int number) { ik_->maxIterations = number; }

void JointPath::setNumericalIkDampingConstant(double damping) { ik_->damping = damping; }

void JointPath::setNumericalIkMaxStagnationCount(int number) { ik_->maxStagnation = number; }

}  // namespace cnoid
