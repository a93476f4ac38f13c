// Choreonoid's own models, in a checkout that is named at configure time: cmake -DREHEARSE_CHOREONOID_SOURCE=DIR. Its
// files aren't part of this repository, so without it these tests are skipped. The expected numbers were computed by an
// independent reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/body.h>

#include <filesystem>
#include <iostream>
#include <map>
#include <set>

namespace {

using rehearse::Model;

constexpr double exact = 1e-9;
constexpr double written = 5e-7;  // the table has six or seven digits

std::string checkout() { return CHOREONOID_SOURCE; }

class BodyOfChoreonoid : public testing::Test {
 protected:
  void SetUp() override {
    if (checkout().empty()) GTEST_SKIP() << "there is no checkout of Choreonoid: -DREHEARSE_CHOREONOID_SOURCE=DIR";
  }

  static Model load(const std::string& name) {
    auto model = rehearse::load_body(checkout() + "/share/model/" + name);
    EXPECT_TRUE(model.ok()) << rehearse::to_string(model.errors());
    return model ? *std::move(model) : Model();
  }

  static std::vector<Eigen::Isometry3d> at_zero(const Model& model) {
    return forward_kinematics(model, model.links.front().joint.origin, std::vector<double>(model.joints.size(), 0.0));
  }

  static Eigen::Vector3d centre(const Model& model) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const auto poses = at_zero(model);
    for (std::size_t i = 0; i < poses.size(); ++i)
      sum += model.links[i].inertial.mass * (poses[i] * model.links[i].inertial.center);
    return sum / model.mass();
  }

  static const rehearse::Link& link(const Model& model, const std::string& name) {
    return model.links.at(static_cast<std::size_t>(model.find_link(name)));
  }

  static Eigen::Isometry3d pose(const Model& model, const std::string& name) {
    return at_zero(model).at(static_cast<std::size_t>(model.find_link(name)));
  }
};

void expect_near(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), tolerance) << "got\n" << a << "\nexpected\n" << b;
}

/// Links; joints with an id, others that aren't fixed, fixed links (a free root is none of them); mass [kg].
struct Count {
  const char* file;
  std::size_t links;
  int identified, others, fixed;
  double mass;
};

TEST_F(BodyOfChoreonoid, HaveTheLinksJointsAndMassesOfTheTable) {
  const Count counts[] = {{"SR1/SR1.body", 30, 29, 0, 0, 130.8},
                          {"PA10/PA10.body", 10, 9, 0, 1, 35.21},
                          {"Tank/Tank.body", 5, 2, 2, 0, 30.0},
                          {"AizuSpider/AizuSpiderNS.body", 11, 4, 6, 0, 84.02468},
                          {"AizuSpider/AizuSpiderSS.body", 24, 13, 6, 4, 88.05002},
                          {"DoubleArmV7/DoubleArmV7S.body", 27, 16, 10, 0, 1986.80986},
                          {"UniversalRobots/UR5-2F85.body", 18, 12, 0, 6, 23.921463},
                          {"misc/FourWheelCar.body", 7, 2, 4, 0, 21.0},
                          {"SR1/SR1-2D.body", 30, -1, -1, -1, 130.8},
                          {"SR1/SR1DH.body", 30, -1, -1, -1, 130.8},
                          {"SR1/SR1Hand.body", 30, -1, -1, -1, 130.8},
                          {"SR1/SR1-floor-box.body", 32, -1, -1, -1, 132.0},
                          {"AizuWheel/AizuWheel.body", 20, -1, -1, -1, 46.51172},
                          {"misc/crawler.body", 3, -1, -1, -1, 12.0},
                          {"misc/conveyor.body", 2, -1, -1, -1, 30.0},
                          {"misc/pendulum.body", 2, -1, -1, -1, 11.0},
                          {"misc/SpringModel.body", 2, -1, -1, -1, 20.0},
                          {"misc/box2.body", 1, -1, -1, -1, 0.2}};
  for (const Count& count : counts) {
    SCOPED_TRACE(count.file);
    if (!std::filesystem::exists(checkout() + "/share/model/" + count.file)) {
      ADD_FAILURE() << "the checkout has no such file";
      continue;
    }
    const Model model = load(count.file);
    EXPECT_EQ(model.links.size(), count.links);
    EXPECT_NEAR(model.mass(), count.mass, 5e-6);
    if (count.identified < 0) continue;
    int identified = 0, others = 0, fixed = 0;
    for (const rehearse::Link& link : model.links) {
      const rehearse::Joint& joint = link.joint;
      if (joint.controller_id.value_or(-1) >= 0)
        ++identified;
      else if (joint.type == rehearse::JointType::fixed)
        ++fixed;
      else if (link.parent >= 0)
        ++others;
    }
    EXPECT_EQ(identified, count.identified);
    EXPECT_EQ(others, count.others);
    EXPECT_EQ(fixed, count.fixed);
  }
}

TEST_F(BodyOfChoreonoid, StandAsInTheTableAtZero) {
  const Model sr1 = load("SR1/SR1.body");
  expect_near(pose(sr1, "CHEST").translation(), Eigen::Vector3d(0, 0, 1.2395), exact);
  expect_near(pose(sr1, "LARM_WRIST_R").translation(), Eigen::Vector3d(0, 0.21, 0.7295), exact);
  expect_near(pose(sr1, "RLEG_ANKLE_R").translation(), Eigen::Vector3d(0, -0.09, 0.06), exact);
  EXPECT_EQ(link(sr1, "CHEST").joint.controller_id, 28);
  EXPECT_EQ(link(sr1, "RLEG_ANKLE_R").joint.controller_id, 5);
  EXPECT_EQ(sr1.find_link("LARM_WRIST_R"), 10);
  expect_near(link(sr1, "RLEG_ANKLE_R").inertial.center, Eigen::Vector3d(0.28, 0, -0.2), exact);
  expect_near(centre(sr1), Eigen::Vector3d(0.031606, 0, 0.754847), written);

  const Model pa10 = load("PA10/PA10.body");
  expect_near(pose(pa10, "J7").translation(), Eigen::Vector3d(-0.0025, 0, 1.345), exact);
  EXPECT_EQ(link(pa10, "HAND_R").joint.controller_id, 8);
  EXPECT_NEAR(link(pa10, "HAND_L").joint.upper, 0.03, exact);
  expect_near(centre(pa10), Eigen::Vector3d(-0.000192, 0, 0.954875), written);

  const Model spider = load("AizuSpider/AizuSpiderSS.body");
  expect_near(pose(spider, "HAND").translation(), Eigen::Vector3d(0.1375744, -0.094, 0.6143393), written);
  expect_near(pose(spider, "HAND").linear(), (Eigen::Matrix3d() << 0, 0, 1, 0, 1, 0, -1, 0, 0).finished(), exact);
  expect_near(centre(spider), Eigen::Vector3d(-0.034736, -0.005053, 0.188167), written);

  const Model arms = load("DoubleArmV7/DoubleArmV7S.body");
  expect_near(pose(arms, "TFRAME").translation(), Eigen::Vector3d(0, 0, 0.52), exact);
  expect_near(pose(arms, "TRACK_L").translation(), Eigen::Vector3d(-0.7, 0.6, 0.225), exact);
  expect_near(pose(arms, "MANIFNG_U").linear(),
              (Eigen::Matrix3d() << -0.117853, -0.993031, 0, 0, 0, 1, -0.993031, 0.117853, 0).finished(), written);
  EXPECT_NEAR(link(arms, "MANIFNG_U").inertial.mass, 1.32092, exact);
  expect_near(centre(arms), Eigen::Vector3d(0.267741, 0.005289, 0.748211), written);

  const Model ur5 = load("UniversalRobots/UR5-2F85.body");
  expect_near(pose(ur5, "WRIST3").translation(), Eigen::Vector3d(0.81725, 0.10915, -0.005491), exact);
  expect_near(pose(ur5, "FLANGE").linear(), (Eigen::Matrix3d() << 0, -1, 0, 0, 0, 1, -1, 0, 0).finished(), exact);
  EXPECT_EQ(link(ur5, "WRIST3").inertial.mass, 1.0);
  EXPECT_EQ(link(ur5, "WRIST3").inertial.inertia, Eigen::Matrix3d::Identity());
  expect_near(centre(ur5), Eigen::Vector3d(0.356234, 0.079343, 0.061923), written);
}

TEST_F(BodyOfChoreonoid, MergeTheRigidBodiesOfALink) {
  const Model spider = load("AizuSpider/AizuSpiderNS.body");
  const rehearse::Inertial& chassis = link(spider, "CHASSIS").inertial;
  EXPECT_NEAR(chassis.mass, 74.57048, 5e-6);
  expect_near(chassis.center, Eigen::Vector3d(-0.047087, -0.0008919, 0.1398223), written);
  expect_near(chassis.inertia,
              (Eigen::Matrix3d() << 2.611820, -0.007413, -0.182089, -0.007413, 4.038066, 0.027035, -0.182089, 0.027035,
               4.436438)
                  .finished(),
              1e-6);
  const rehearse::Inertial& flipper = link(spider, "FR_FLIPPER").inertial;
  EXPECT_NEAR(flipper.mass, 1.78789, exact);
  expect_near(flipper.center, Eigen::Vector3d(0.1297309, 0.0030193, 0.0448677), written);
  expect_near(centre(spider), Eigen::Vector3d(-0.041789, -0.000792, 0.169958), written);
}

TEST_F(BodyOfChoreonoid, TakeTheTankApart) {
  const Model tank = load("Tank/Tank.body");
  expect_near(pose(tank, "CHASSIS").translation(), Eigen::Vector3d(0, 0, 0.106), exact);
  expect_near(pose(tank, "TRACK_L").translation(), Eigen::Vector3d(0, 0.22, 0.08), exact);
  expect_near(pose(tank, "TURRET_Y").translation(), Eigen::Vector3d(-0.04, 0, 0.2185), exact);
  EXPECT_EQ(link(tank, "TRACK_L").joint.type, rehearse::JointType::track);
  EXPECT_EQ(link(tank, "TRACK_L").joint.controller_id, -1);
  EXPECT_NEAR(link(tank, "TRACK_L").inertial.mass, 7.0, exact);
  const rehearse::Joint& pitch = link(tank, "TURRET_P").joint;
  expect_near(pitch.axis, -Eigen::Vector3d::UnitY(), exact);
  EXPECT_NEAR(pitch.lower, -0.174533, written);
  EXPECT_NEAR(pitch.upper, 0.785398, written);
  std::vector<std::string> names;
  for (const rehearse::Device& device : tank.devices) names.push_back(device.name);
  // Theta is left out: it has two fish-eye lenses.
  EXPECT_THAT(names, testing::ElementsAre("ACCEL_SENSOR", "GYRO", "Kinect", "VLP-16", "Light"));
  const rehearse::Device& lidar = tank.devices.at(3);
  expect_near(lidar.pose.translation(), Eigen::Vector3d(0.03, 0, 0.27), exact);
  const auto& sensor = std::get<rehearse::RangeSensor>(lidar.kind);
  EXPECT_EQ(sensor.yaw.samples, 901);
  EXPECT_EQ(sensor.pitch.samples, 16);
  expect_near(centre(tank), Eigen::Vector3d(-0.004, 0, 0.133533), written);
}

TEST_F(BodyOfChoreonoid, HaveTheDevicesOfSr1InOrder) {
  const Model sr1 = load("SR1/SR1.body");
  std::vector<std::string> names;
  for (const rehearse::Device& device : sr1.devices) names.push_back(device.name);
  EXPECT_THAT(names, testing::ElementsAre("WaistAccelSensor", "WaistGyro", "WaistIMU", "LeftCamera", "RightCamera",
                                          "LeftAnkleForceSensor", "RightAnkleForceSensor"));
  const rehearse::Device& camera = sr1.devices.at(3);
  expect_near(camera.pose.translation(), Eigen::Vector3d(0.15, 0.05, 0.15), exact);
  expect_near(camera.pose.linear(), (Eigen::Matrix3d() << 0, 0, -1, -1, 0, 0, 0, 1, 0).finished(), 1e-4);
  EXPECT_EQ(link(sr1, "RLEG_ANKLE_R").material, "Sole");
}

/// Prints a line for each file that doesn't load. `REHEARSE_BODY_TABLE` in the environment: for all.
TEST_F(BodyOfChoreonoid, LoadAllButAFew) {
  std::set<std::filesystem::path> files;
  for (const char* folder : {"share", "sample"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(checkout() + "/" + folder))
      if (entry.path().extension() == ".body") files.insert(entry.path());
  const bool prints_all = std::getenv("REHEARSE_BODY_TABLE") != nullptr;
  std::size_t loaded = 0;
  for (const auto& file : files) {
    const auto model = rehearse::load_body(file);
    loaded += model.ok() ? 1 : 0;
    const std::string name = file.lexically_relative(checkout()).string();
    if (!model) {
      std::cout << name << ": " << rehearse::to_string(model.errors().front()) << "\n";
    } else if (prints_all) {
      std::map<rehearse::Severity, int> counts;
      for (const auto& finding : model->report) ++counts[finding.severity];
      std::cout << name << ": " << model->links.size() << " links, " << model->joints.size() << " joints, "
                << model->devices.size() << " devices, " << counts[rehearse::Severity::repair] << " repairs, "
                << counts[rehearse::Severity::warning] << " warnings, " << counts[rehearse::Severity::note]
                << " notes\n";
    }
  }
  std::cout << loaded << " of " << files.size() << " files load\n";
  EXPECT_GE(files.size(), 201u);
  EXPECT_GE(loaded, 195u);
}

/// What a recording contains is enough to load the model again, without any file.
TEST_F(BodyOfChoreonoid, LoadAgainFromTheTextOfARecording) {
  for (const char* file : {"Tank/Tank.body", "AizuSpider/AizuSpiderSS.body", "Labo1/Labo1v2.body"}) {
    SCOPED_TRACE(file);
    const Model model = load(file);
    rehearse::UrdfOptions options;
    options.meshes = rehearse::UrdfOptions::Meshes::skip;
    const auto again = rehearse::parse_model(model.source_text, "elsewhere/model.body", options);
    ASSERT_TRUE(again.ok()) << rehearse::to_string(again.errors());
    ASSERT_EQ(again->links.size(), model.links.size());
    EXPECT_EQ(again->mass(), model.mass());
    EXPECT_EQ(again->devices.size(), model.devices.size());
    EXPECT_EQ(again->source_text, model.source_text);
  }
}

}  // namespace
