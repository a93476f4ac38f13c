// fixtures/models/sr1.urdf against the data of the robot, which are written here a second time.
#include <rehearse/urdf.h>

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace rehearse {
namespace {

const Model& sr1() {
  static const Model model = [] {
    Result<Model> result = load_urdf(FIXTURES_DIR "/models/sr1.urdf");
    if (!result) ADD_FAILURE() << to_string(result.errors());
    return result ? std::move(*result) : Model{};
  }();
  return model;
}

const Link& sr1_link(std::string_view name) { return sr1().links.at(static_cast<std::size_t>(sr1().find_link(name))); }

const Device& device(std::string_view name) {
  return sr1().devices.at(static_cast<std::size_t>(sr1().find_device(name)));
}

struct Figures {
  const char* name;
  double mass;             // [kg]
  Eigen::Vector3d center;  // [m]
  Eigen::Vector3d origin;  // of the joint in the parent link [m]
  Eigen::Vector3d axis;
  double lower, upper;  // [rad]
};

const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();

/// By joint id.
const std::array<Figures, 29> figures = {{
    {"RLEG_HIP_R", 2.5, {0, -0.1, 0}, {0, -0.09, 0}, x, -0.785398, 0.785398},
    {"RLEG_HIP_P", 2, {0, 0, -0.15}, {0, 0, 0}, y, -1.57, 1.57},
    {"RLEG_HIP_Y", 5.1, {0, -0.04, 0}, {0, 0, -0.3535}, z, -1.0472, 1.0472},
    {"RLEG_KNEE", 7, {0, 0, -0.3}, {0, 0, 0}, y, 0, 2.61799},
    {"RLEG_ANKLE_P", 2.5, {-0.15, 0, 0}, {0, 0, -0.3}, y, -1.39626, 0.785398},
    {"RLEG_ANKLE_R", 1.9, {0.28, 0, -0.2}, {0, 0, 0}, x, -0.785398, 0.785398},
    {"RARM_SHOULDER_P", 3, {0.1, 0, 0}, {0, -0.21, 0}, y, -3.14, 3.14},
    {"RARM_SHOULDER_R", 0.6, {0, 0, -0.1}, {0, 0, 0}, x, -3.14, 0.785398},
    {"RARM_SHOULDER_Y", 1, {0, 0, 0}, {0, 0, -0.263}, z, -1.57, 1.57},
    {"RARM_ELBOW", 0.6, {0, 0, -0.3}, {0, 0, 0}, y, -2.61799, 0},
    {"RARM_WRIST_Y", 0.4, {0, 0, 0.1}, {0, 0, -0.247}, z, -1.57, 1.57},
    {"RARM_WRIST_P", 0.4, {-0.1, 0, 0}, {0, 0, 0}, y, -1.57, 1.57},
    {"RARM_WRIST_R", 0.4, {0, 0, -0.1}, {0, 0, 0}, x, -1.57, 1.57},
    {"LLEG_HIP_R", 2.5, {0, 0.1, 0}, {0, 0.09, 0}, x, -0.785398, 0.785398},
    {"LLEG_HIP_P", 2, {0, 0, -0.15}, {0, 0, 0}, y, -1.57, 1.57},
    {"LLEG_HIP_Y", 5.1, {0, 0.04, 0}, {0, 0, -0.3535}, z, -1.0472, 1.0472},
    {"LLEG_KNEE", 7, {0, 0, -0.3}, {0, 0, 0}, y, 0, 2.61799},
    {"LLEG_ANKLE_P", 2.5, {-0.15, 0, 0}, {0, 0, -0.3}, y, -1.39626, 0.785398},
    {"LLEG_ANKLE_R", 1.9, {0.28, 0, -0.2}, {0, 0, 0}, x, -0.785398, 0.785398},
    {"LARM_SHOULDER_P", 3, {0.1, 0, 0}, {0, 0.21, 0}, y, -3.14, 3.14},
    {"LARM_SHOULDER_R", 0.6, {0, 0, -0.1}, {0, 0, 0}, x, -0.785398, 3.14159},
    {"LARM_SHOULDER_Y", 1, {0, 0, 0}, {0, 0, -0.263}, z, -1.57, 1.57},
    {"LARM_ELBOW", 0.6, {0, 0, -0.3}, {0, 0, 0}, y, -2.61799, 0},
    {"LARM_WRIST_Y", 0.4, {0, 0, 0.1}, {0, 0, -0.247}, z, -1.57, 1.57},
    {"LARM_WRIST_P", 0.4, {-0.1, 0, 0}, {0, 0, 0}, y, -1.57, 1.57},
    {"LARM_WRIST_R", 0.4, {0, 0, -0.1}, {0, 0, 0}, x, -1.57, 1.57},
    {"WAIST_P", 6, {0, 0, -0.1}, {0, 0, 0.176}, y, -1.57, 1.57},
    {"WAIST_R", 30, {0.11, 0, 0.25}, {0, 0, 0}, x, -1.0472, 1.0472},
    {"CHEST", 13, {0, 0, 0}, {0, 0, 0.35}, z, -1.57, 1.57},
}};

TEST(Sr1, HasTwentyNineJointsInTheOrderOfTheirIds) {
  ASSERT_EQ(sr1().joints.size(), figures.size());
  for (std::size_t id = 0; id < figures.size(); ++id) {
    const Link& moved = sr1().links.at(static_cast<std::size_t>(sr1().joints[id]));
    EXPECT_EQ(moved.joint.name, figures[id].name);
    EXPECT_EQ(moved.name, figures[id].name);
    EXPECT_EQ(moved.joint.id, static_cast<int>(id));
    EXPECT_EQ(moved.joint.type, JointType::revolute);
  }
}

TEST(Sr1, HasTheJointsOfItsTable) {
  for (const Figures& each : figures) {
    const Joint& joint = sr1_link(each.name).joint;
    EXPECT_EQ(joint.origin.translation(), each.origin) << each.name;
    EXPECT_EQ(joint.origin.linear(), Eigen::Matrix3d::Identity()) << each.name;
    EXPECT_EQ(joint.axis, each.axis) << each.name;
    EXPECT_EQ(joint.lower, each.lower) << each.name;
    EXPECT_EQ(joint.upper, each.upper) << each.name;
    EXPECT_EQ(joint.effort, 500) << each.name;
    EXPECT_EQ(joint.velocity, std::string_view(each.name) == "RARM_ELBOW" ? unlimited : 10) << each.name;
  }
}

TEST(Sr1, HasTheMassesOfItsTable) {
  EXPECT_NEAR(sr1().mass(), 130.8, 1e-9);
  EXPECT_EQ(sr1_link("WAIST").inertial.mass, 27);
  EXPECT_EQ(sr1_link("WAIST").inertial.center, Eigen::Vector3d(0, 0, 0.0375));
  for (const Figures& each : figures) {
    EXPECT_EQ(sr1_link(each.name).inertial.mass, each.mass) << each.name;
    EXPECT_EQ(sr1_link(each.name).inertial.center, each.center) << each.name;
  }
  for (const Link& each : sr1().links) EXPECT_EQ(each.inertial.inertia, Eigen::Matrix3d::Identity()) << each.name;
}

TEST(Sr1, BranchesAtTheWaistAndTheChest) {
  EXPECT_EQ(sr1().links.size(), 30u);
  EXPECT_EQ(sr1().links[0].name, "WAIST");
  EXPECT_EQ(sr1().links[0].joint.type, JointType::free);
  const auto parent = [](const char* name) {
    return sr1().links.at(static_cast<std::size_t>(sr1_link(name).parent)).name;
  };
  for (const char* name : {"RLEG_HIP_R", "LLEG_HIP_R", "WAIST_P"}) EXPECT_EQ(parent(name), "WAIST") << name;
  for (const char* name : {"RARM_SHOULDER_P", "LARM_SHOULDER_P"}) EXPECT_EQ(parent(name), "CHEST") << name;
  EXPECT_EQ(parent("CHEST"), "WAIST_R");
  EXPECT_EQ(parent("LLEG_ANKLE_R"), "LLEG_ANKLE_P");
}

TEST(Sr1, ShowsTheShapesThatTouch) {
  std::size_t shapes = 0;
  for (const Link& each : sr1().links) {
    EXPECT_EQ(each.visuals.size(), each.collisions.size()) << each.name;
    shapes += each.collisions.size();
    for (const Shape& visual : each.visuals) EXPECT_TRUE(visual.color) << each.name;
  }
  EXPECT_EQ(shapes, 47u);
  EXPECT_EQ(sr1_link("CHEST").collisions.size(), 4u);
}

TEST(Sr1, StandsOnItsSolesAtTheStartingHeight) {
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  root.translation().z() = 0.7135;
  const auto poses = forward_kinematics(sr1(), root, std::vector<double>(29, 0.0));
  for (const char* foot : {"RLEG_ANKLE_R", "LLEG_ANKLE_R"}) {
    const Shape& sole = sr1_link(foot).collisions.at(1);
    EXPECT_EQ(std::get<Box>(sole.geometry).size, Eigen::Vector3d(0.25, 0.14, 0.01));
    const double bottom =
        (poses.at(static_cast<std::size_t>(sr1().find_link(foot))) * sole.pose).translation().z() - 0.01 / 2;
    EXPECT_NEAR(bottom, 0.005, 1e-9) << foot;  // legs straight: 5 mm in the air
  }
}

TEST(Sr1, FeelsWithItsWaistAndAnkles) {
  const auto expect = [](const char* name, const char* type, const char* on, int id) {
    ASSERT_GE(sr1().find_device(name), 0) << name;
    EXPECT_EQ(type_name(device(name)), type) << name;
    EXPECT_EQ(device(name).link, sr1().find_link(on)) << name;
    EXPECT_EQ(device(name).id, id) << name;
    EXPECT_EQ(device(name).pose.matrix(), Eigen::Matrix4d::Identity()) << name;
  };
  EXPECT_EQ(sr1().devices.size(), 7u);
  expect("WaistAccelSensor", "AccelerationSensor", "WAIST", 0);
  expect("WaistGyro", "RateGyroSensor", "WAIST", 0);
  expect("WaistIMU", "Imu", "WAIST", 0);
  expect("LeftAnkleForceSensor", "ForceSensor", "LLEG_ANKLE_R", 0);
  expect("RightAnkleForceSensor", "ForceSensor", "RLEG_ANKLE_R", 1);
}

TEST(Sr1, SeesWithTwoRangeCameras) {
  const auto expect = [](const char* name, int id, double side) {
    ASSERT_GE(sr1().find_device(name), 0) << name;
    EXPECT_EQ(type_name(device(name)), "RangeCamera");
    EXPECT_EQ(device(name).id, id);
    EXPECT_EQ(device(name).link, sr1().find_link("CHEST"));
    EXPECT_EQ(device(name).pose.translation(), Eigen::Vector3d(0.15, side, 0.15));
    EXPECT_EQ(device(name).pose.linear() * -z, x);  // looks ahead
    EXPECT_EQ(device(name).pose.linear() * y, z);   // upright
    const Camera& camera = std::get<Camera>(device(name).kind);
    EXPECT_EQ(camera.width, 640);
    EXPECT_EQ(camera.height, 480);
    EXPECT_NEAR(camera.field_of_view, std::numbers::pi / 4, 1e-15);
    EXPECT_EQ(camera.near_clip, 0.1);
    EXPECT_EQ(camera.far_clip, 200);
    EXPECT_EQ(camera.frame_rate, 30);
  };
  expect("LeftCamera", 0, 0.05);
  expect("RightCamera", 1, -0.05);
}

TEST(Sr1, LoadsWithoutRepairsOrWarnings) {
  for (const Diagnostic& each : sr1().report) EXPECT_EQ(each.severity, Severity::note) << to_string(each);
}

}  // namespace
}  // namespace rehearse
