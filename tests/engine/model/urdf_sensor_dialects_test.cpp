// Sensors in other forms than Gazebo's <sensor> of one device: in <robot> itself, several cameras in one sensor, and
// the special elements of force sensors and contact sensors.
#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rehearse {
namespace {

using testing::HasSubstr;

const double quarter = std::acos(0.0);

/// base, an arm on a hinge, a hand fixed to the arm and turned about z, and additional elements.
Model with(const std::string& more, const std::string& hand_shapes = "") {
  return load(
      robot(link("base") + link("arm") + link("hand", hand_shapes) + joint("hinge", "continuous", "base", "arm") +
            joint("weld", "fixed", "arm", "hand", "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/>") + more));
}

const Device& only_device(const Model& model) {
  static const Device none;
  EXPECT_EQ(model.devices.size(), 1u);
  return model.devices.empty() ? none : model.devices[0];
}

TEST(UrdfSensorsOfRobot, ThatGazeboHasTooAreOneSensor) {
  const Model model = with(block("hand", "<sensor name='s' type='imu'><pose>1 0 0 0 0 0</pose></sensor>") +
                           "<sensor name='s' type='accelerometer'><parent link='hand'/></sensor>");
  EXPECT_EQ(only_device(model).pose.translation(), Eigen::Vector3d(1, 0, 0)) << "the first counts";
  ASSERT_EQ(model.report.size(), 1u) << to_string(model.report);
  EXPECT_EQ(model.report[0].severity, Severity::note);
  EXPECT_THAT(model.report[0].message, HasSubstr("a sensor's second description"));
}

TEST(UrdfSensorsOfRobot, NameTheirLinkAndStandAtTheirOrigin) {
  const std::pair<const char*, const char*> types[] = {
      {"imu", "Imu"}, {"accelerometer", "AccelerationSensor"}, {"gyroscope", "RateGyroSensor"}};
  for (const auto& [type, device] : types) {
    const Model model = with("<sensor name='s' type='" + std::string(type) +
                             "'><parent link='hand'/><origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/></sensor>");
    EXPECT_EQ(type_name(only_device(model)), device);
    EXPECT_EQ(only_device(model).link, model.find_link("hand"));
    EXPECT_EQ(only_device(model).pose.translation(), Eigen::Vector3d(1, 0, 0));
    EXPECT_TRUE(only_device(model).pose.linear().col(0).isApprox(Eigen::Vector3d::UnitY()));
    EXPECT_EQ(to_string(model.report), "");
  }
}

TEST(UrdfSensorsOfRobot, OfForceNameTheirJoint) {
  const Model model = with("<sensor name='f' type='force_torque'><parent joint='weld'/></sensor>");
  EXPECT_EQ(only_device(model).link, model.find_link("hand"));
  EXPECT_EQ(type_name(only_device(model)), "ForceSensor");
}

TEST(UrdfSensorsOfRobot, MeanALinkBySayingLinkWhateverJointsAreCalled) {
  const Model model =
      load(robot(link("base") + link("hand") + link("arm") + joint("hand", "continuous", "base", "arm") +
                 joint("wrist", "continuous", "arm", "hand") +
                 "<sensor name='l' type='force_torque'><parent link='hand'/></sensor>"
                 "<sensor name='j' type='imu'><parent joint='hand'/></sensor>"));
  EXPECT_EQ(model.devices[static_cast<std::size_t>(model.find_device("l"))].link, model.find_link("hand"));
  EXPECT_EQ(model.devices[static_cast<std::size_t>(model.find_device("j"))].link, model.find_link("arm"));
}

TEST(UrdfSensorsOfRobot, WithTheWordsOfSdfLookAlongX) {
  const Model model = with(
      "<sensor name='s' type='depth'><parent link='arm'/><camera><image><width>64</width></image></camera></sensor>");
  EXPECT_EQ(type_name(only_device(model)), "RangeCamera");
  EXPECT_EQ(std::get<Camera>(only_device(model).kind).width, 64);
  EXPECT_EQ(only_device(model).pose.linear() * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
}

TEST(UrdfSensorsOfRobot, StandAmongThoseOfBlocksInTheOrderOfTheDocument) {
  const Model model =
      with(block("arm", "<sensor name='a' type='imu'/>") + "<sensor name='b' type='imu'><parent link='arm'/></sensor>" +
           block("arm", "<sensor name='c' type='imu'/>"));
  ASSERT_EQ(model.devices.size(), 3u);
  EXPECT_EQ(model.devices[1].name, "b");
}

TEST(UrdfSensorsOfRobot, WithoutATypeAreNoted) {
  const Model model =
      with("<sensor name='gyro'><parent link='arm'/></sensor><sensor name='x'><parent link='arm'/></sensor>");
  EXPECT_TRUE(model.devices.empty());
  EXPECT_THAT(to_string(model.report),
              HasSubstr("note: a sensor without a type is ignored, here and in 1 other places"));
}

/// The form of the ROS wiki.
std::string optical_camera(const std::string& image, const std::string& of_sensor = "") {
  return "<sensor name='eye' " + of_sensor + "><parent link='arm'/><origin xyz='1 2 3'/><camera><image " + image +
         " format='rgb8' near='0.2' far='30'/></camera></sensor>";
}

TEST(UrdfOpticalCamera, LooksAlongZWithYDownToTheLastBit) {
  const Model model = with(optical_camera("width='64' height='48' hfov='1'"));
  const Eigen::Matrix3d axes = only_device(model).pose.linear();
  EXPECT_EQ(axes * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());  // forward
  EXPECT_EQ(axes * Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY());  // up
  EXPECT_EQ(axes * Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitX());   // right
  EXPECT_EQ(only_device(model).pose.translation(), Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfOpticalCamera, ReadsItsAttributes) {
  const Model model =
      with(optical_camera("width='200.0' height='100' hfov='1.5707963267948966'", "update_rate='12.5'"));
  const Camera& eye = std::get<Camera>(only_device(model).kind);
  EXPECT_EQ(eye.width, 200);
  EXPECT_EQ(eye.height, 100);
  EXPECT_NEAR(std::tan(eye.field_of_view / 2), 0.5, 1e-15);  // upright, of a right angle across
  EXPECT_EQ(eye.near_clip, 0.2);
  EXPECT_EQ(eye.far_clip, 30.0);
  EXPECT_EQ(eye.frame_rate, 12.5);
  EXPECT_FALSE(eye.depth);
}

TEST(UrdfOpticalCamera, MayHaveATypeAndMeasureDepth) {
  const std::string image = "width='64' height='48' hfov='1' depth_format='mono16'";
  EXPECT_EQ(type_name(only_device(with(optical_camera(image)))), "RangeCamera");
  EXPECT_EQ(type_name(only_device(with(optical_camera(image, "type='camera'")))), "RangeCamera");
  const std::string color = "width='64' height='48' hfov='1'";
  EXPECT_EQ(type_name(only_device(with(optical_camera(color, "type='depth'")))), "RangeCamera");
  EXPECT_EQ(type_name(only_device(with(optical_camera(color, "type='camera'")))), "Camera");
}

TEST(UrdfOpticalCamera, TakesOnePictureASecondUnlessToldOtherwise) {
  EXPECT_EQ(std::get<Camera>(only_device(with(optical_camera("width='64' height='48' hfov='1'"))).kind).frame_rate,
            1.0);
}

TEST(UrdfOpticalRangeSensor, ReadsItsAttributesAndLooksAlongZ) {
  const Model model = with(
      "<sensor name='laser' update_rate='20'><parent link='arm'/><ray><horizontal samples='100' resolution='0.5' "
      "min_angle='-1' max_angle='1.5'/><vertical samples='1' min_angle='0' max_angle='0.5'/></ray></sensor>");
  const RangeSensor& laser = std::get<RangeSensor>(only_device(model).kind);
  EXPECT_EQ(laser.yaw.samples, 50);
  EXPECT_EQ(laser.yaw.lower, -1.0);
  EXPECT_EQ(laser.yaw.upper, 1.5);
  EXPECT_EQ(laser.pitch.samples, 1);
  EXPECT_EQ(laser.pitch.lower, 0.25);
  EXPECT_EQ(laser.scan_rate, 20.0);
  EXPECT_EQ(only_device(model).pose.linear() * -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());
}

TEST(UrdfMulticamera, IsACameraForEachOfItsChildren) {
  const Model model = with(
      block("arm",
            "<sensor name='rig' type='multicamera'><pose>0 0 1 0 0 0</pose><id>4</id><update_rate>12</update_rate>"
            "<camera name='left'><pose>0 0.1 0 0 0 0</pose><image><width>64</width><height>48</height></image></camera>"
            "<camera name='right'><pose>0 -0.1 0 0 0 0</pose></camera><camera/></sensor>"));
  ASSERT_EQ(model.devices.size(), 3u);
  EXPECT_EQ(model.devices[0].name, "rig_left");
  EXPECT_EQ(model.devices[1].name, "rig_right");
  EXPECT_EQ(model.devices[2].name, "rig_2");
  EXPECT_EQ(model.devices[0].pose.translation(), Eigen::Vector3d(0, 0.1, 1));
  EXPECT_EQ(model.devices[1].pose.translation(), Eigen::Vector3d(0, -0.1, 1));
  EXPECT_EQ(model.devices[1].id, 5);
  EXPECT_EQ(std::get<Camera>(model.devices[0].kind).width, 64);
  EXPECT_EQ(std::get<Camera>(model.devices[1].kind).width, 320);
  EXPECT_EQ(std::get<Camera>(model.devices[1].kind).frame_rate, 12.0);
}

Eigen::Isometry3d force_pose(const std::string& frame, const std::string& reference = "weld") {
  return only_device(
             with(block(reference, "<sensor name='f' type='force_torque'><pose>0 0 1 0 0 0.5</pose><force_torque>" +
                                       frame + "</force_torque></sensor>")))
      .pose;
}

TEST(UrdfForceSensor, MeasuresAtItsPoseUnlessToldOtherwise) {
  for (const char* frame : {"", "<frame>sensor</frame>"}) {
    const Eigen::Isometry3d pose = force_pose(frame);
    EXPECT_EQ(pose.translation(), Eigen::Vector3d(0, 0, 1)) << frame;
    EXPECT_TRUE(pose.linear().isApprox(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  }
}

TEST(UrdfForceSensor, OfItsChildMeasuresInTheFrameOfItsLink) {
  EXPECT_TRUE(force_pose("<frame>child</frame>").matrix().isIdentity(0.0));
}

TEST(UrdfForceSensor, OfItsParentMeasuresAlongTheAxesOfTheParentLink) {
  const Eigen::Isometry3d pose = force_pose("<frame>parent</frame>");
  EXPECT_EQ(pose.translation(), Eigen::Vector3d::Zero());
  // The hand is turned by a right angle about z: its parent's x is its own -y.
  EXPECT_TRUE(pose.linear().isApprox(Eigen::AngleAxisd(-quarter, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  EXPECT_TRUE(
      force_pose("<frame>parent</frame>", "hinge").matrix().isIdentity(0.0));  // with a warning: the joint turns
}

TEST(UrdfForceSensor, FromChildToParentIsOurs) {
  const Model model = with(block("weld",
                                 "<sensor name='f' type='force_torque'><force_torque>"
                                 "<measure_direction>child_to_parent</measure_direction></force_torque></sensor>"));
  EXPECT_EQ(to_string(model.report), "");
}

/// Index of the contact sensor's shape in a hand with three shapes, of which the last has no name.
int feeling(const std::string& names) {
  const std::string sphere = "<geometry><sphere radius='1'/></geometry></collision>";
  const Model model =
      with(block("hand", "<sensor name='skin' type='contact'><contact>" + names + "</contact></sensor>"),
           "<collision name='palm'>" + sphere + "<collision name='thumb_collision'>" + sphere + "<collision>" + sphere);
  EXPECT_EQ(type_name(only_device(model)), "ContactSensor");
  return std::get<ContactSensor>(only_device(model).kind).collision;
}

TEST(UrdfContactSensor, FeelsWithAllShapesUnlessItNamesOne) {
  EXPECT_EQ(feeling(""), -1);
  EXPECT_EQ(feeling("<collision>palm</collision>"), 0);
  EXPECT_EQ(feeling("<collision> thumb_collision </collision>"), 1);
}

TEST(UrdfContactSensor, MayNameItsShapeAsGazeboWould) {
  const std::pair<const char*, int> names[] = {{"hand_collision", 0},
                                               {"hand_collision_1", 1},
                                               {"hand_collision_2", 2},
                                               {"arm_fixed_joint_lump__hand_collision", 0},
                                               {"arm_fixed_joint_lump__hand_collision_2", 2},
                                               {"arm_fixed_joint_lump__palm_collision", 0},
                                               {"arm_fixed_joint_lump__palm_collision_1", 0},
                                               {"arm_fixed_joint_lump__thumb_collision", 1},
                                               {"robot::hand::hand_collision_1", 1},
                                               {"palm_collision", 0},
                                               {"hand_collision_3", -1},
                                               {"hand_collision_", -1},
                                               {"hand_collision_x", -1},
                                               {"hand_collision_-1", -1},
                                               {"foot_collision", -1},
                                               {"hand", -1}};
  for (const auto& [name, shape] : names)
    EXPECT_EQ(feeling("<collision>" + std::string(name) + "</collision>"), shape) << name;
}

/// A calf with one shape, a foot fixed below it, and a contact sensor on the calf.
Model with_foot(const std::string& names, const std::string& foot_shapes, const std::string& reference = "calf") {
  const std::string calf_shape = "<collision name='collision'><geometry><box size='1 1 1'/></geometry></collision>";
  return load(robot(link("base") + link("calf", some_inertial + calf_shape) + link("foot", foot_shapes) +
                    joint("knee", "continuous", "base", "calf") +
                    joint("ankle", "fixed", "calf", "foot", "<origin xyz='0 0 -0.25' rpy='0 0 1.5707963267948966'/>") +
                    block(reference, "<sensor name='skin' type='contact'><pose>0 0 1 0 0 0</pose><contact>" + names +
                                         "</contact></sensor>")));
}

const std::string one_ball = "<collision><geometry><sphere radius='1'/></geometry></collision>";
const std::string two_balls = one_ball + "<collision name='toe'><geometry><sphere radius='1'/></geometry></collision>";

TEST(UrdfContactSensor, OfALinkThatGazeboMergesFindsTheFoot) {
  const Model model = with_foot("<collision>calf_fixed_joint_lump__foot_collision_1</collision>", one_ball);
  EXPECT_EQ(only_device(model).link, model.find_link("foot"));
  EXPECT_EQ(std::get<ContactSensor>(only_device(model).kind).collision, -1);
  // It stays where it was: 1 m above the knee, along the calf's axes.
  EXPECT_TRUE(only_device(model).pose.translation().isApprox(Eigen::Vector3d(0, 0, 1.25)));
  EXPECT_TRUE((only_device(model).pose.linear() * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_EQ(to_string(model.report), "");
}

TEST(UrdfContactSensor, CountsTheShapesOfMergedLinksAsGazeboDoes) {
  // The merged link has the calf's shape, number 0, and the foot's, 1 and 2.
  const std::pair<const char*, int> names[] = {{"calf_fixed_joint_lump__foot_collision_1", 0},
                                               {"calf_fixed_joint_lump__foot_collision_2", 1},
                                               {"calf_fixed_joint_lump__toe_collision_2", 1}};
  for (const auto& [name, shape] : names) {
    const Model model = with_foot("<collision>" + std::string(name) + "</collision>", two_balls);
    EXPECT_EQ(only_device(model).link, model.find_link("foot")) << name;
    EXPECT_EQ(std::get<ContactSensor>(only_device(model).kind).collision, shape) << name;
  }
}

TEST(UrdfContactSensor, FindsTheFootByTheShapesOwnNameAsPyBulletKeepsIt) {
  const Model model = with_foot("<collision>toe</collision>", two_balls);
  EXPECT_EQ(only_device(model).link, model.find_link("foot"));
  EXPECT_EQ(std::get<ContactSensor>(only_device(model).kind).collision, 1);
}

TEST(UrdfContactSensor, PrefersTheShapeOfItsOwnLink) {
  const std::string same = "<collision name='collision'><geometry><sphere radius='1'/></geometry></collision>";
  const Model model = with_foot("<collision>collision</collision>", same, "foot");
  EXPECT_EQ(only_device(model).link, model.find_link("foot"));
}

TEST(UrdfContactSensor, MayReferToTheMergedLink) {
  const Model model = with_foot("", one_ball, "calf_fixed_joint_lump__foot");
  EXPECT_EQ(only_device(model).link, model.find_link("foot"));
}

TEST(UrdfContactSensor, OfShapesOfTwoLinksFeelsWithItsOwnLink) {
  const Model model = with_foot("<collision>collision</collision><collision>toe</collision>", two_balls);
  EXPECT_EQ(only_device(model).link, model.find_link("calf"));
  EXPECT_THAT(to_string(model.report),
              HasSubstr("'skin' names collision shapes of several links; contacts of all shapes of link "
                        "'calf' count"));
}

TEST(UrdfContactSensor, ThatNamesEachShapeNamesAll) {
  EXPECT_EQ(feeling("<collision>palm</collision><collision>thumb_collision</collision>"
                    "<collision>hand_collision_2</collision>"),
            -1);
  EXPECT_EQ(feeling("<collision>palm</collision><collision>hand_collision</collision>"), 0);  // twice the same
}

TEST(UrdfSensors, BehindAFixedJointKeepTheirPoseInTheirLink) {
  const Model model = with(block("hand", "<sensor name='i' type='imu'><pose>0 0 1 0 0 0.5</pose></sensor>"));
  EXPECT_EQ(model.links[static_cast<std::size_t>(only_device(model).link)].name, "hand");
  EXPECT_EQ(only_device(model).pose.translation(), Eigen::Vector3d(0, 0, 1));
}

TEST(UrdfSensors, SayWhatIsPassedOverOnceAKind) {
  const std::string more = "<always_on>1</always_on><visualize>0</visualize><topic>t</topic><plugin/>";
  const std::string report = to_string(
      with(block("arm", "<sensor name='a' type='imu'>" + more + "</sensor><sensor name='b' type='imu'>" + more +
                            "<update_rate>0</update_rate></sensor><sensor name='w' type='wideanglecamera'/>"))
          .report);
  for (const char* kind : {"always_on", "visualize", "topic", "plugin"})
    EXPECT_THAT(report, HasSubstr("note: <sensor><" + std::string(kind) + "> is ignored, here and in 1 other places"));
  EXPECT_THAT(report, HasSubstr("note: <sensor><update_rate> is ignored"));
  EXPECT_THAT(report, HasSubstr("note: a sensor of type 'wideanglecamera' is ignored"));
}

}  // namespace
}  // namespace rehearse
