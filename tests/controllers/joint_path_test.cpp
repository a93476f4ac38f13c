#include <gtest/gtest.h>
#include <cnoid/EigenUtil>
#include <cnoid/JointPath>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bodies.h"

namespace {

using cnoid::BodyPtr;
using cnoid::Isometry3;
using cnoid::JointPath;
using cnoid::Link;
using cnoid::Vector3;

class SixJointArm : public testing::Test {
 protected:
  SixJointArm() {
    set(start_);
    path_->calcForwardKinematics();
  }

  void set(const std::vector<double>& q) {
    for (int i = 0; i < 6; ++i) body_->joint(i)->q() = q[static_cast<std::size_t>(i)];
  }
  std::vector<double> get() const {
    std::vector<double> q;
    for (int i = 0; i < 6; ++i) q.push_back(body_->joint(i)->q());
    return q;
  }
  /// The pose of the arm's end with these angles; the arm itself doesn't move.
  Isometry3 pose_at(const std::vector<double>& q) const {
    const BodyPtr copy = body_->clone();
    for (int i = 0; i < 6; ++i) copy->joint(i)->q() = q[static_cast<std::size_t>(i)];
    copy->calcForwardKinematics();
    return copy->link("L6")->T();
  }
  Isometry3 out_of_reach() const {
    Isometry3 goal = Isometry3::Identity();
    goal.translation() = Vector3(5, 0, 0);
    return goal;
  }

  const std::vector<double> start_{0.1, 0.4, 0.9, -0.2, 0.3, 0.1};
  BodyPtr body_ = rehearse::test::make_six_joint_arm();
  Link* hand_ = body_->link("L6");
  std::shared_ptr<JointPath> path_ = JointPath::getCustomPath(body_->rootLink(), hand_);
};

TEST_F(SixJointArm, HasItsJointsInTheOrderOfThePath) {
  ASSERT_EQ(path_->numJoints(), 6);
  EXPECT_EQ(path_->joint(5), hand_);
  EXPECT_EQ((*path_)[0], body_->joint(0));
  EXPECT_EQ(path_->indexOf(body_->joint(3)), 3);
  EXPECT_EQ(path_->indexOf(body_->rootLink()), -1);
  EXPECT_EQ(path_->baseLink(), body_->rootLink());
  EXPECT_EQ(path_->endLink(), hand_);
  EXPECT_TRUE(path_->isJointDownward(0));
  EXPECT_FALSE(path_->hasCustomIK());
}

TEST_F(SixJointArm, IsFoundByTheOldFormWithABodyToo) {
  EXPECT_EQ(JointPath::getCustomPath(body_, body_->rootLink(), hand_)->numJoints(), 6);
}

TEST_F(SixJointArm, ReachesAGoalAndIsExactlyThere) {
  const Isometry3 goal = pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_EQ(hand_->T().matrix(), goal.matrix());
  EXPECT_TRUE(pose_at(get()).isApprox(goal, 2e-7)) << "the angles must lead to where the link says it is";
  EXPECT_GT(path_->numIterations(), 2);
  EXPECT_LT(path_->numIterations(), 20);
}

TEST_F(SixJointArm, StaysAtItsForwardKinematicsIfNotToldToBeExact) {
  path_->setNumericalIkExactEndPositionEnabled(false);
  const Isometry3 goal = pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_NE(hand_->T().matrix(), goal.matrix());
  EXPECT_TRUE(hand_->T().isApprox(pose_at(get()), 1e-14));
}

TEST_F(SixJointArm, TakesNoStepIfItIsThereAlready) {
  ASSERT_TRUE(path_->calcInverseKinematics(pose_at(start_)));
  EXPECT_EQ(path_->numIterations(), 0);
  EXPECT_EQ(get(), start_);
}

TEST_F(SixJointArm, ReturnsToItsStartFromAGoalOutOfReach) {
  const Isometry3 before = hand_->T();
  EXPECT_FALSE(path_->calcInverseKinematics(out_of_reach()));
  EXPECT_EQ(get(), start_);
  EXPECT_EQ(hand_->T().matrix(), before.matrix());
}

TEST_F(SixJointArm, GivesUpOnAGoalThatIsNoNumber) {
  Isometry3 goal = pose_at(start_);
  goal.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(path_->calcInverseKinematics(goal));
  EXPECT_EQ(get(), start_);
}

TEST_F(SixJointArm, StretchesTowardsAGoalOutOfReachIfItIsToDoItsBest) {
  Isometry3 goal = pose_at({0.1, 1.2, 0.0, 0.0, 0.0, 0.0});  // stretched, and then 5 cm more
  goal.translation() += 0.05 * goal.linear().col(0);
  const double before = (goal.translation() - hand_->p()).norm();
  path_->setNumericalIkDampingConstant(0.05);  // near what can't be reached undamped steps grow without bound
  path_->setBestEffortIkEnabled(true);
  EXPECT_FALSE(path_->calcInverseKinematics(goal));
  EXPECT_LT((goal.translation() - hand_->p()).norm(), 0.5 * before);
  EXPECT_TRUE(hand_->T().isApprox(pose_at(get()), 1e-13));
}

TEST_F(SixJointArm, MakesTheStepsThatItMay) {
  path_->setNumericalIkMaxIterations(2);
  EXPECT_FALSE(path_->calcInverseKinematics(pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8})));
  EXPECT_EQ(path_->numIterations(), 2);
}

TEST_F(SixJointArm, ComesNearerTheGoalWithASmallerTolerance) {
  path_->setNumericalIkExactEndPositionEnabled(false);
  const Isometry3 goal = pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  path_->setNumericalIkMaxIkError(1e-3);
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  const double coarse = (hand_->p() - goal.translation()).norm();
  path_->setNumericalIkMaxIkError(1e-10);
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_LT((hand_->p() - goal.translation()).norm(), 1e-10);
  EXPECT_GT(coarse, 1e-8);
}

TEST_F(SixJointArm, NeedsMoreStepsIfTheyAreSmallOrDamped) {
  const Isometry3 goal = pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  path_->calcInverseKinematics(goal);
  const int usual = path_->numIterations();
  set(start_);
  path_->calcForwardKinematics();
  path_->setNumericalIkDeltaScale(0.5);
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_GT(path_->numIterations(), usual);
  set(start_);
  path_->calcForwardKinematics();
  path_->setNumericalIkDeltaScale(0.9);
  path_->setNumericalIkDampingConstant(0.1);
  ASSERT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_GT(path_->numIterations(), usual);
}

TEST_F(SixJointArm, TakesTheEqualAngleNearestToItsStart) {
  std::vector<double> turned = start_;
  turned[0] += 2 * cnoid::PI;
  set(turned);
  path_->calcForwardKinematics();
  ASSERT_TRUE(path_->calcInverseKinematics(pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8})));
  EXPECT_NEAR(body_->joint(0)->q(), 2 * cnoid::PI + 0.1, cnoid::PI);
}

TEST_F(SixJointArm, TakesAnEqualAngleWithinTheLimits) {
  // The first joint starts at 3.0 and must turn on to 3.4; of 3.4 and 3.4 - 2 pi only the second is allowed.
  body_->joint(0)->setJointRange(-cnoid::PI, cnoid::PI);
  std::vector<double> q = start_;
  q[0] = 3.0;
  set(q);
  path_->calcForwardKinematics();
  q[0] = 3.4;
  ASSERT_TRUE(path_->calcInverseKinematics(pose_at(q)));
  EXPECT_NEAR(body_->joint(0)->q(), 3.4 - 2 * cnoid::PI, 1e-5);
}

TEST_F(SixJointArm, IgnoresLimitsUnlessToldToKeepThem) {
  const Isometry3 goal = pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  body_->joint(1)->setJointRange(-0.5, 0.5);
  EXPECT_TRUE(path_->calcInverseKinematics(goal));
  EXPECT_NEAR(body_->joint(1)->q(), 0.7, 1e-5);
  set(start_);
  path_->calcForwardKinematics();
  path_->setIkJointLimitEnabled(true);
  EXPECT_FALSE(path_->calcInverseKinematics(goal));
}

TEST_F(SixJointArm, MovesWithItsBase) {
  const Isometry3 end = pose_at({0.4, 0.6, 0.6, 0.2, -0.3, 0.6});
  Isometry3 base = Isometry3::Identity();
  base.translation() = Vector3(0.25, 0, 0);
  const Isometry3 goal = base * pose_at({0.5, 0.7, 0.5, 0.3, -0.4, 0.8});
  ASSERT_TRUE(path_->setBaseLinkGoal(base).calcInverseKinematics(goal));
  EXPECT_EQ(body_->rootLink()->p(), Vector3(0.25, 0, 0));
  EXPECT_NEAR(body_->joint(1)->q(), 0.7, 1e-5);
  EXPECT_TRUE(path_->calcInverseKinematics(Vector3::Zero(), base.linear(), end.translation(), end.linear()));
  EXPECT_EQ(body_->rootLink()->p(), Vector3::Zero());
}

TEST_F(SixJointArm, SolvesThePathFromTheHandToTheBaseAsWell) {
  JointPath reverse(hand_, body_->rootLink());
  ASSERT_EQ(reverse.numJoints(), 6);
  EXPECT_FALSE(reverse.isJointDownward(0));
  EXPECT_EQ(reverse.joint(0), hand_);
  EXPECT_EQ(reverse.jointAtIdOrder(0), body_->joint(0));
  EXPECT_EQ(reverse.jointIndexAtIdOrder(0), 5);
  Isometry3 goal = Isometry3::Identity();  // where the base shall be, while the hand stays
  goal.translation() = Vector3(0.05, -0.1, 0.1);
  const Isometry3 hand = hand_->T();
  ASSERT_TRUE(reverse.calcInverseKinematics(goal));
  EXPECT_EQ(hand_->T().matrix(), hand.matrix());
  body_->calcForwardKinematics();  // from the base, which is at the goal
  EXPECT_TRUE(hand_->T().isApprox(hand, 1e-6));
}

TEST_F(SixJointArm, HasAJacobianThatIsTheDerivativeOfItsPose) {
  Eigen::MatrixXd J;
  path_->calcJacobian(J);
  ASSERT_EQ(J.rows(), 6);
  ASSERT_EQ(J.cols(), 6);
  const double step = 1e-6;
  const Isometry3 here = pose_at(start_);
  for (int i = 0; i < 6; ++i) {
    std::vector<double> q = start_;
    q[static_cast<std::size_t>(i)] += step;
    const Isometry3 there = pose_at(q);
    cnoid::Vector6 derivative;
    derivative << there.translation() - here.translation(),
        here.linear() * cnoid::omegaFromRot(here.linear().transpose() * there.linear());
    EXPECT_TRUE(J.col(i).isApprox(derivative / step, 1e-5)) << "joint " << i;
  }
}

TEST_F(SixJointArm, SolvesATaskOfTheUsersOwn) {
  const Vector3 goal = pose_at({0.5, 0.7, 0.5, 0, 0, 0}).translation();  // a place only, in whatever orientation
  path_->customizeTarget(
      3,
      [&](cnoid::VectorXd& error) {
        error = goal - hand_->p();
        return error.squaredNorm();
      },
      [&](cnoid::MatrixXd& jacobian) {
        Eigen::MatrixXd whole;
        path_->calcJacobian(whole);
        jacobian = whole.topRows(3);
      });
  ASSERT_TRUE(path_->calcInverseKinematics());
  EXPECT_TRUE(hand_->p().isApprox(goal, 1e-6));
}

TEST_F(SixJointArm, HasNoTaskButThePoseUnlessItIsGivenOne) {
  EXPECT_FALSE(path_->calcInverseKinematics());
  EXPECT_THROW(path_->customizeTarget(3, nullptr, nullptr), std::invalid_argument);
}

TEST_F(SixJointArm, LosesItsSettingsWithItsPath) {
  path_->setIkJointLimitEnabled(true);
  path_->setBestEffortIkEnabled(true);
  ASSERT_TRUE(path_->setPath(body_->rootLink(), body_->link("L3")));
  EXPECT_EQ(path_->numJoints(), 3);
  EXPECT_FALSE(path_->isIkJointLimitEnabled());
  EXPECT_FALSE(path_->isBestEffortIkEnabled());
}

TEST(JointPath, LeavesOutJointsThatAreFixedOrHaveNoId) {
  const BodyPtr body = rehearse::test::make_six_joint_arm();
  body->joint(1)->setJointType(Link::FixedJoint);
  body->joint(3)->setJointId(-1);
  EXPECT_EQ(JointPath(body->rootLink(), body->link("L6")).numJoints(), 4);
}

TEST(JointPath, BendsAroundWhereTheWaysMeet) {
  const BodyPtr body = rehearse::test::make_arm();
  const JointPath path(body->link("HAND"), body->link("TOOL"));
  ASSERT_EQ(path.numJoints(), 1) << "the joint above ARM moves HAND and TOOL alike";
  EXPECT_EQ(path.joint(0), body->link("HAND"));
  EXPECT_FALSE(path.isJointDownward(0));
}

TEST(JointPath, MovesALinkThatIsItsWholePath) {
  const BodyPtr body = rehearse::test::make_arm();
  JointPath path(body->rootLink(), body->rootLink());
  EXPECT_TRUE(path.empty());
  Isometry3 goal = Isometry3::Identity();
  goal.translation() = Vector3(1, 2, 3);
  EXPECT_TRUE(path.calcInverseKinematics(goal));
  EXPECT_EQ(body->rootLink()->p(), Vector3(1, 2, 3));
}

TEST(JointPath, HasNoSolutionWithoutJoints) {
  const BodyPtr body = rehearse::test::make_arm();
  JointPath path(body->link("ARM"), body->link("TOOL"));
  EXPECT_FALSE(path.calcInverseKinematics(Isometry3::Identity()));
  EXPECT_FALSE(JointPath().calcInverseKinematics(Isometry3::Identity()));
}

TEST(JointPath, RefusesANullLink) {
  const BodyPtr body = rehearse::test::make_arm();
  EXPECT_THROW(JointPath::getCustomPath(body->rootLink(), nullptr), std::invalid_argument);
}

TEST_F(SixJointArm, IsFoundByTheFunctionOfEarlierReleases) {
  const cnoid::JointPathPtr path = cnoid::getCustomJointPath(body_, body_->rootLink(), hand_);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->numJoints(), 6);
  EXPECT_FALSE(path->hasAnalyticalIK());
  path->setBestEffortIKmode(true);
  EXPECT_TRUE(path->isBestEffortIKmode());
}

}  // namespace
