#include <rehearse/model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace rehearse {
namespace {

/// Moments of a solid by random points in its bounding box: independent of the formulas in solid_inertial.
Eigen::Vector3d sampled_moments(const Eigen::Vector3d& half, const auto& is_inside, double mass) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int inside = 0;
  for (int i = 0; i < 400'000; ++i) {
    const Eigen::Vector3d p = half.cwiseProduct(Eigen::Vector3d(side(generator), side(generator), side(generator)));
    if (!is_inside(p)) continue;
    ++inside;
    const Eigen::Vector3d square = p.cwiseAbs2();
    sum += Eigen::Vector3d(square.y() + square.z(), square.z() + square.x(), square.x() + square.y());
  }
  return mass * sum / inside;
}

void expect_moments(const Inertial& inertial, const Eigen::Vector3d& expected) {
  const double rough = 0.01 * expected.maxCoeff();  // 400,000 samples: about 0.2 %
  EXPECT_LT((inertial.inertia.diagonal() - expected).cwiseAbs().maxCoeff(), rough) << inertial.inertia;
  EXPECT_TRUE(inertial.inertia.isDiagonal());
  EXPECT_TRUE(inertial.center.isZero());
}

TEST(SolidInertial, OfABoxIsWhatItsPointsAddUpTo) {
  expect_moments(solid_inertial(Box{{1.0, 2.0, 3.0}}, 5.0),
                 sampled_moments(
                     {0.5, 1.0, 1.5}, [](const auto&) { return true; }, 5.0));
}

TEST(SolidInertial, OfASphereIsWhatItsPointsAddUpTo) {
  expect_moments(solid_inertial(Sphere{0.7}, 2.0),
                 sampled_moments(
                     Eigen::Vector3d::Constant(0.7), [](const auto& p) { return p.norm() < 0.7; }, 2.0));
}

TEST(SolidInertial, OfACylinderIsWhatItsPointsAddUpTo) {
  expect_moments(solid_inertial(Cylinder{0.4, 2.0}, 3.0),
                 sampled_moments(
                     {0.4, 0.4, 1.0}, [](const auto& p) { return p.template head<2>().norm() < 0.4; }, 3.0));
}

TEST(SolidInertial, OfACapsuleIsWhatItsPointsAddUpTo) {
  const auto is_inside = [](const Eigen::Vector3d& p) {
    return (p - Eigen::Vector3d(0, 0, std::clamp(p.z(), -0.5, 0.5))).norm() < 0.4;
  };
  expect_moments(solid_inertial(Capsule{0.4, 1.0}, 3.0), sampled_moments({0.4, 0.4, 0.9}, is_inside, 3.0));
}

TEST(SingleShapeModel, IsOneFreeLinkNamedLikeTheModel) {
  const Model model = single_shape_model("crate", Box{{1, 1, 1}}, 6.0, Color(1, 0, 0, 1));
  ASSERT_EQ(model.links.size(), 1u);
  EXPECT_EQ(model.name, "crate");
  EXPECT_EQ(model.links[0].name, "crate");
  EXPECT_EQ(model.links[0].joint.type, JointType::free);
  EXPECT_EQ(model.mass(), 6.0);
  EXPECT_NEAR(model.links[0].inertial.inertia(0, 0), 1.0, 1e-15);  // m a² / 6
  ASSERT_EQ(model.links[0].visuals.size(), 1u);
  EXPECT_EQ(model.links[0].visuals[0].color, Color(1, 0, 0, 1));
  EXPECT_EQ(model.links[0].collisions.size(), 1u);
  EXPECT_TRUE(model.joints.empty());
}

/// A free base, a hinge about z one metre ahead, a slide along x one metre further.
Model hinge_and_slide() {
  Model model = single_shape_model("base", Sphere{0.1}, 1.0, std::nullopt);
  Link arm;
  arm.name = "arm";
  arm.parent = 0;
  arm.joint.name = "hinge";
  arm.joint.type = JointType::revolute;
  arm.joint.id = 0;
  arm.joint.axis = Eigen::Vector3d::UnitZ();
  arm.joint.origin.translation() = Eigen::Vector3d::UnitX();
  Link slide = arm;
  slide.name = "sled";
  slide.parent = 1;
  slide.joint.name = "slide";
  slide.joint.type = JointType::prismatic;
  slide.joint.id = 1;
  slide.joint.axis = Eigen::Vector3d::UnitX();
  model.links.push_back(arm);
  model.links.push_back(slide);
  model.joints = {1, 2};
  return model;
}

TEST(ForwardKinematics, TurnsAndSlidesAlongTheChain) {
  const Eigen::Isometry3d root(Eigen::Translation3d(0, 0, 5));
  const auto poses = forward_kinematics(hinge_and_slide(), root, {std::numbers::pi / 2, 0.5});
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_TRUE(poses[0].isApprox(root));
  EXPECT_TRUE(poses[1].translation().isApprox(Eigen::Vector3d(1, 0, 5)));
  EXPECT_TRUE(poses[2].translation().isApprox(Eigen::Vector3d(1, 1.5, 5)));  // ahead is now +y
  EXPECT_TRUE(poses[2].linear().col(0).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(ForwardKinematics, AtZeroIsExact) {
  const auto poses = forward_kinematics(hinge_and_slide(), Eigen::Isometry3d::Identity(), {0.0, 0.0});
  EXPECT_EQ(poses[2].linear(), Eigen::Matrix3d::Identity());
  EXPECT_EQ(poses[2].translation(), Eigen::Vector3d(2, 0, 0));
}

TEST(Model, FindsLinksJointsAndDevicesByName) {
  Model model = hinge_and_slide();
  model.devices.push_back({"imu", 0, 1, Eigen::Isometry3d::Identity(), Imu{}, 0});
  EXPECT_EQ(model.find_link("sled"), 2);
  EXPECT_EQ(model.find_link("slide"), -1);
  EXPECT_EQ(model.find_joint("slide"), 2);
  EXPECT_EQ(model.find_joint("sled"), 2);  // a link's name will do
  EXPECT_EQ(model.find_joint("leg"), -1);
  EXPECT_EQ(model.find_joint(""), -1);  // the root's joint has no name, and none is not a name
  EXPECT_EQ(model.find_device("imu"), 0);
  EXPECT_EQ(model.find_device("arm"), -1);
}

TEST(Model, PrefersAJointOfThatNameToALink) {
  Model model = hinge_and_slide();
  model.links[2].joint.name = "arm";
  EXPECT_EQ(model.find_joint("arm"), 2);
  EXPECT_EQ(model.find_link("arm"), 1);
}

TEST(Device, TypeNamesAreThoseOfTheControllerApi) {
  const auto name = [](DeviceKind kind) {
    Device device;
    device.kind = kind;
    return std::string(type_name(device));
  };
  Camera depth;
  depth.depth = true;
  EXPECT_EQ(name(ForceSensor{}), "ForceSensor");
  EXPECT_EQ(name(Gyro{}), "RateGyroSensor");
  EXPECT_EQ(name(Accelerometer{}), "AccelerationSensor");
  EXPECT_EQ(name(Imu{}), "Imu");
  EXPECT_EQ(name(Camera{}), "Camera");
  EXPECT_EQ(name(depth), "RangeCamera");
}

TEST(ForwardKinematics, PutsALinkBehindAFloatingJointWhereItIs) {
  Model model;
  model.links.resize(3);
  model.links[1].parent = 0;
  model.links[1].joint.origin = Eigen::Translation3d(1, 0, 0);
  model.links[2].parent = 1;
  model.links[2].joint.type = JointType::fixed;
  model.links[2].joint.origin = Eigen::Translation3d(0, 0, 0.5);
  const Eigen::Isometry3d root(Eigen::Translation3d(0, 2, 0));
  EXPECT_EQ(forward_kinematics(model, root, {})[2].translation(), Eigen::Vector3d(1, 2, 0.5));
  const auto poses = forward_kinematics(model, root, {}, [](std::size_t link, const Eigen::Isometry3d& by_default) {
    EXPECT_EQ(link, 1u);
    EXPECT_EQ(by_default.translation(), Eigen::Vector3d(1, 2, 0));
    return Eigen::Isometry3d(Eigen::Translation3d(7, 8, 9));
  });
  EXPECT_EQ(poses[0].translation(), Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(poses[1].translation(), Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(poses[2].translation(), Eigen::Vector3d(7, 8, 9.5));
}

}  // namespace
}  // namespace rehearse
