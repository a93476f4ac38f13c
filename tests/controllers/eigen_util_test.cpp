#include <gtest/gtest.h>
#include <cnoid/EigenUtil>

namespace {

using cnoid::Isometry3;
using cnoid::Matrix3;
using cnoid::PI;
using cnoid::PI_2;
using cnoid::Vector3;
using cnoid::Vector3f;
using cnoid::Vector6;

TEST(MathUtil, ConvertsDegreesAndRadians) {
  EXPECT_DOUBLE_EQ(cnoid::radian(180), PI);
  EXPECT_DOUBLE_EQ(cnoid::radian(90.0), PI_2);
  EXPECT_FLOAT_EQ(cnoid::radian(90.0f), static_cast<float>(PI_2));
  EXPECT_DOUBLE_EQ(cnoid::degree(PI), 180.0);
  EXPECT_TRUE(cnoid::radian(Vector3(180, 90, 0)).isApprox(Vector3(PI, PI_2, 0)));
  EXPECT_TRUE(cnoid::degree(Vector3(PI, 0, PI_2)).isApprox(Vector3(180, 0, 90)));
}

TEST(RollPitchYaw, TurnsAboutXThenYThenZ) {
  const Matrix3 expected = (cnoid::AngleAxis(0.3, Vector3::UnitZ()) * cnoid::AngleAxis(0.2, Vector3::UnitY()) *
                            cnoid::AngleAxis(0.1, Vector3::UnitX()))
                               .toRotationMatrix();
  EXPECT_TRUE(cnoid::rotFromRpy(0.1, 0.2, 0.3).isApprox(expected));
  EXPECT_TRUE(cnoid::rpyFromRot(expected).isApprox(Vector3(0.1, 0.2, 0.3)));
}

TEST(RollPitchYaw, GiveTheSameRotationEverywhere) {
  for (double roll = -3.0; roll <= 3.0; roll += 0.75) {
    for (double pitch = -1.5; pitch <= 1.5; pitch += 0.5) {
      const Matrix3 R = cnoid::rotFromRpy(roll, pitch, -roll / 2);
      EXPECT_TRUE(cnoid::rotFromRpy(cnoid::rpyFromRot(R)).isApprox(R, 1e-14)) << roll << " " << pitch;
    }
  }
}

TEST(RollPitchYaw, HaveNoYawStraightUpAndDown) {
  for (const double pitch : {PI_2, -PI_2}) {
    const Matrix3 R = cnoid::rotFromRpy(0.4, pitch, 0.1);
    const Vector3 rpy = cnoid::rpyFromRot(R);
    EXPECT_EQ(rpy.z(), 0.0);
    EXPECT_TRUE(cnoid::rotFromRpy(rpy).isApprox(R, 1e-12));
  }
}

TEST(RollPitchYaw, FollowThePreviousAngles) {
  // Through the top of a loop, past half a turn of yaw, and at the singular pitch itself.
  for (const Vector3& angles : {Vector3(0.1, 2.0, 0.2), Vector3(0.0, 0.1, 3.0 * PI), Vector3(7.0, -2.5, -4.0),
                                Vector3(0.6, PI_2, 0.2), Vector3(0.6, -PI_2, 0.2)}) {
    const Vector3 rpy = cnoid::rpyFromRot(cnoid::rotFromRpy(angles), angles + Vector3(0.01, -0.01, 0.01));
    EXPECT_TRUE(rpy.isApprox(angles, 0.02)) << rpy.transpose() << " for " << angles.transpose();
    EXPECT_TRUE(cnoid::rotFromRpy(rpy).isApprox(cnoid::rotFromRpy(angles), 1e-12)) << angles.transpose();
  }
}

TEST(OmegaFromRot, IsAxisTimesAngle) {
  const Vector3 axis = Vector3(1, 2, 3).normalized();
  for (const double angle : {0.0, 1e-9, 0.5, 3.0, PI - 1e-9}) {
    const Matrix3 R = cnoid::AngleAxis(angle, axis).toRotationMatrix();
    EXPECT_TRUE(cnoid::omegaFromRot(R).isApprox(angle * axis, 1e-7)) << angle;
  }
}

TEST(Hat, IsTheCrossProduct) {
  const Vector3 x(1, 2, 3);
  const Vector3 y(-4, 5, 6);
  EXPECT_TRUE((cnoid::hat(x) * y).isApprox(x.cross(y)));
}

TEST(VectorText, ReadsBackExactly) {
  const Vector3 v(0.1, -1.0 / 3.0, 1e300);
  Vector3 read;
  EXPECT_TRUE(cnoid::toVector3(cnoid::str(v), read));
  EXPECT_EQ(read, v);
  EXPECT_EQ(cnoid::str(Vector3(1, 2.5, -3)), "1 2.5 -3");
  EXPECT_EQ(cnoid::str(Vector3f(0.1f, 0, 0)), "0.1 0 0");
  EXPECT_EQ(cnoid::str(cnoid::AngleAxis(0.5, Vector3::UnitX())), "1 0 0 0.5");
}

TEST(VectorText, TakesSpacesAndCommas) {
  Vector3 v;
  Vector6 six;
  EXPECT_TRUE(cnoid::toVector3(" 1, +2 ,3e1 ", v));
  EXPECT_EQ(v, Vector3(1, 2, 30));
  EXPECT_TRUE(cnoid::toVector6("1 2 3 4 5 6", six));
  EXPECT_EQ(six[5], 6.0);
}

TEST(VectorText, RefusesAnythingElse) {
  Vector3 v;
  for (const char* text : {"", "1 2", "1 2 3 4", "1,,2 3", "1 2 x", "1 2 3,", "+-1 2 3"}) {
    EXPECT_FALSE(cnoid::toVector3(text, v)) << text;
  }
}

TEST(NormalizeRotation, MakesADriftedRotationOrthonormal) {
  Matrix3 R = cnoid::rotFromRpy(0.1, 0.2, 0.3);
  const Matrix3 clean = R;
  R(0, 1) += 1e-3;
  R *= 1.01;
  cnoid::normalizeRotation(R);
  EXPECT_TRUE((R.transpose() * R).isApprox(Matrix3::Identity(), 1e-14));
  EXPECT_TRUE(R.isApprox(clean, 1e-2));
  Isometry3 T = Isometry3::Identity();
  T.linear() *= 2.0;
  cnoid::normalizeRotation(T);
  EXPECT_TRUE(T.linear().isApprox(Matrix3::Identity()));
}

TEST(SE3, ConvertsFromATransform) {
  Isometry3 T = Isometry3::Identity();
  T.translation() = Vector3(1, 2, 3);
  cnoid::SE3 pose(T);
  EXPECT_EQ(pose.translation(), Vector3(1, 2, 3));
  EXPECT_TRUE(pose.rotation().isApprox(cnoid::Quaternion::Identity()));
  pose.clear();
  EXPECT_EQ(pose.translation(), Vector3(0, 0, 0));
}

}  // namespace
