#include <rehearse/urdf.h>

#include "urdf_texts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "support/temporary_folder.h"
#include "urdf/known_robots.h"

namespace rehearse {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> link_names(const Model& model) {
  std::vector<std::string> names;
  for (const Link& each : model.links) names.push_back(each.name);
  return names;
}

TEST(UrdfLoader, OrdersLinksDepthFirstAndJointIdsByDocument) {
  const std::string fixed_range = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const Model model =
      load(robot(link("root") + link("z") + link("a") + link("m") + link("b") + joint("to_m", "continuous", "z", "m") +
                 joint("to_z", "revolute", "root", "z", fixed_range) + joint("weld", "fixed", "root", "b") +
                 joint("to_a", "prismatic", "root", "a", fixed_range)));
  EXPECT_THAT(link_names(model), ElementsAre("root", "z", "m", "b", "a"));
  EXPECT_THAT(model.joints, ElementsAre(2, 1, 4));  // to_m, to_z, to_a; the weld has no id
  EXPECT_EQ(model.links[2].joint.id, 0);
  EXPECT_EQ(model.links[2].parent, 1);
  EXPECT_EQ(model.links[3].joint.id, -1);
  EXPECT_EQ(model.links[3].joint.type, JointType::fixed);
  EXPECT_EQ(model.links[4].joint.type, JointType::prismatic);
}

TEST(UrdfLoader, RootIsFreeUnlessItIsTheWorld) {
  EXPECT_EQ(load(robot(link("base"))).links[0].joint.type, JointType::free);
  EXPECT_EQ(load(robot(link("world", ""))).links[0].joint.type, JointType::fixed);
}

TEST(UrdfLoader, WarnsOfLimitsThatLookLikeDegrees) {
  const auto report = [](const std::string& lower, const std::string& upper, const std::string& type = "revolute") {
    const std::string limit = "<limit lower='" + lower + "' upper='" + upper + "' effort='1' velocity='1'/>";
    return to_string(load(robot(link("base") + link("arm") + joint("hinge", type, "base", "arm", limit))).report);
  };
  const std::pair<const char*, const char*> degrees[] = {{"-180", "180"}, {"-90", "90"}, {"-360", "360"},
                                                         {"0", "90"},     {"-170", "0"}, {"-1", "185"}};
  for (const auto& [lower, upper] : degrees)
    EXPECT_THAT(report(lower, upper), HasSubstr("which look like degrees")) << lower << " " << upper;
  EXPECT_THAT(report("-180", "180"), HasSubstr("in radians: -3.1416 and 3.1416"));
  EXPECT_EQ(report("-180", "180", "prismatic"), "");  // metres
  const std::pair<const char*, const char*> radians[] = {
      {"-3.14159", "3.14159"}, {"-100", "100"}, {"-1000", "1000"}, {"-6.28", "6.28"}, {"-20", "20"}};
  for (const auto& [lower, upper] : radians) EXPECT_EQ(report(lower, upper), "") << lower << " " << upper;
}

TEST(UrdfLoader, AFloatingJointBelowTheWorldMakesAFreeBase) {
  const Model model = load(robot(link("world", "") + link("base") + joint("float", "floating", "world", "base")));
  EXPECT_THAT(link_names(model), ElementsAre("base"));
  EXPECT_EQ(model.links[0].joint.type, JointType::free);
  EXPECT_THAT(to_string(model.report), HasSubstr("link 'base' is the free root"));
}

TEST(UrdfLoader, AFloatingJointFurtherDownMakesAFreeBody) {
  const Model model =
      load(robot(link("root") + link("leaf") +
                 joint("float", "floating", "root", "leaf", "<origin xyz='1 2 3'/><axis xyz='0 0 1'/>")));
  EXPECT_EQ(model.links.at(1).joint.type, JointType::free);
  EXPECT_EQ(model.links[1].joint.id, -1);
  EXPECT_EQ(model.links[1].joint.origin.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_THAT(to_string(model.report), HasSubstr("note: floating joint 'float': link 'leaf' is a free body"));
}

TEST(UrdfLoader, AFloatingJointBesideAnotherMakesAFreeBody) {
  const Model model =
      load(robot(link("world", "") + link("ball") + link("mast") + joint("float", "floating", "world", "ball") +
                 joint("weld", "fixed", "world", "mast")));
  EXPECT_EQ(model.links[0].joint.type, JointType::fixed);
  EXPECT_EQ(model.links.at(static_cast<std::size_t>(model.find_link("ball"))).joint.type, JointType::free);
}

TEST(UrdfLoader, ReadsAJointsFigures) {
  const Model model = load(robot(link("base") + link("arm") +
                                 joint("hinge", "revolute", "base", "arm",
                                       "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><axis xyz='0 3 4'/>"
                                       "<limit lower='-0.5' upper='1.5' effort='20' velocity='3'/>"
                                       "<dynamics damping='0.25' friction='0.125' armature='0.5'/>")));
  const Joint& hinge = model.links[1].joint;
  EXPECT_EQ(hinge.origin.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(hinge.origin.linear().col(0).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(hinge.axis.isApprox(Eigen::Vector3d(0, 0.6, 0.8)));  // normalised
  EXPECT_EQ(hinge.lower, -0.5);
  EXPECT_EQ(hinge.upper, 1.5);
  EXPECT_EQ(hinge.effort, 20);
  EXPECT_EQ(hinge.velocity, 3);
  EXPECT_EQ(hinge.damping, 0.25);
  EXPECT_EQ(hinge.friction, 0.125);
  EXPECT_EQ(hinge.armature, 0.5);
}

TEST(UrdfLoader, ReadsARotorWithoutDamping) {
  const Model model = load(
      robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm", "<dynamics armature='0.5'/>")));
  EXPECT_EQ(model.links[1].joint.armature, 0.5);
  EXPECT_EQ(to_string(model.report), "");
}

TEST(UrdfLoader, RollsThenPitchesThenYawsAboutFixedAxes) {
  const Model model =
      load(still("<visual><origin rpy='0.3 0.5 0.7'/><geometry><sphere radius='1'/></geometry></visual>"));
  const auto about = [](double angle, const Eigen::Vector3d& axis) { return Eigen::AngleAxisd(angle, axis); };
  const Eigen::Matrix3d expected = (about(0.7, Eigen::Vector3d::UnitZ()) * about(0.5, Eigen::Vector3d::UnitY()) *
                                    about(0.3, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_TRUE(model.links[0].visuals[0].pose.linear().isApprox(expected));
}

TEST(UrdfLoader, ARotationCanBeAQuaternionOfAnyLength) {
  // About z, x and y by a right angle each, about (1, 2, 3) by 1 rad, and one with which pitch is 90 degrees.
  const std::vector<Eigen::Quaterniond> rotations = {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ())),
      Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitX())),
      Eigen::Quaterniond(Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitY())),
      Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized())),
      Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))};
  for (const Eigen::Quaterniond& q : rotations) {
    char text[200];
    std::snprintf(text, sizeof text, "<origin quat_xyzw='%.17g %.17g %.17g %.17g'/>", 2 * q.x(), 2 * q.y(), 2 * q.z(),
                  2 * q.w());
    const Model model = load(robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm", text)));
    EXPECT_TRUE(model.links[1].joint.origin.linear().isApprox(q.toRotationMatrix(), 1e-14)) << text;
  }
}

TEST(UrdfLoader, VersionsThatItKnowsAreNoWarning) {
  for (const char* version : {"1", "1.0", "1.1"})
    EXPECT_EQ(
        to_string(load("<robot name='r' version='" + std::string(version) + "'><link name='world'/></robot>").report),
        "");
}

TEST(UrdfLoader, NamesAllRoots) {
  std::string links;
  for (int i = 0; i < 8; ++i) links += link("l" + std::to_string(i));
  EXPECT_THAT(refusal(robot(links)), HasSubstr("8 root links: 'l0', 'l1', 'l2', 'l3', 'l4', 'l5', 'l6', 'l7' ("));
}

TEST(UrdfLoader, AnAbsentAxisIsX) {
  for (const char* axis : {"", "<axis/>"}) {
    const Model model = load(robot(link("base") + link("arm") + joint("hinge", "continuous", "base", "arm", axis)));
    EXPECT_EQ(model.links[1].joint.axis, Eigen::Vector3d::UnitX()) << axis;
  }
}

TEST(UrdfLoader, AContinuousJointHasNoRangeWhateverTheFileSays) {
  const Model model =
      load(robot(link("base") + link("arm") +
                 joint("hinge", "continuous", "base", "arm", "<limit lower='0' upper='0' effort='1' velocity='1'/>")));
  EXPECT_EQ(model.links[1].joint.lower, -unlimited);
  EXPECT_EQ(model.links[1].joint.upper, unlimited);
  EXPECT_THAT(to_string(model.report), HasSubstr("note: the range of a continuous joint is ignored"));
}

TEST(UrdfLoader, AJointWithoutLimitsIsUnlimited) {
  for (const char* type : {"revolute", "prismatic"}) {
    const Model model = load(robot(link("base") + link("arm") + joint("hinge", type, "base", "arm")));
    EXPECT_EQ(model.links[1].joint.lower, -unlimited) << type;
    EXPECT_EQ(model.links[1].joint.effort, unlimited) << type;
    EXPECT_EQ(model.links[1].joint.type == JointType::revolute, std::string(type) == "revolute");
  }
}

TEST(UrdfLoader, AnEffortOrVelocityOfZeroMeansNotGiven) {
  const Model model =
      load(robot(link("base") + link("arm") +
                 joint("hinge", "revolute", "base", "arm", "<limit lower='-1' upper='1' effort='0' velocity='0'/>")));
  EXPECT_EQ(model.links[1].joint.effort, unlimited);
  EXPECT_EQ(model.links[1].joint.velocity, unlimited);
  EXPECT_THAT(to_string(model.report), HasSubstr("note: the velocity limit of joint 'hinge' is 0"));
}

TEST(UrdfLoader, AJointMimicsAnotherWhereverThatStands) {
  const Model model =
      load(robot(link("base") + link("right") + link("left") +
                 joint("R", "prismatic", "base", "right", "<mimic joint='L' multiplier='-2' offset='0.1'/>") +
                 joint("L", "continuous", "base", "left")));
  const auto& mimic = model.links[1].joint.mimic;
  ASSERT_TRUE(mimic.has_value());
  EXPECT_EQ(mimic->leader, 1);
  EXPECT_EQ(mimic->multiplier, -2.0);
  EXPECT_EQ(mimic->offset, 0.1);
  EXPECT_FALSE(model.links[2].joint.mimic.has_value());
}

TEST(UrdfLoader, AChainOfMimicsIsResolvedToItsHead) {
  const Model model = load(robot(link("base") + link("a") + link("b") + link("c") +
                                 joint("C", "continuous", "base", "c", "<mimic joint='B' multiplier='3' offset='5'/>") +
                                 joint("B", "continuous", "base", "b", "<mimic joint='A' multiplier='2' offset='7'/>") +
                                 joint("A", "continuous", "base", "a")));
  const auto& mimic = model.links[1].joint.mimic;
  ASSERT_TRUE(mimic.has_value());
  EXPECT_EQ(mimic->leader, 2);
  EXPECT_EQ(mimic->multiplier, 6.0);
  EXPECT_EQ(mimic->offset, 3.0 * 7.0 + 5.0);
}

TEST(UrdfLoader, AMimicOfAJointThatDoesntMoveIsPassedOver) {
  const Model model = load(robot(link("base") + link("a") + link("b") + joint("A", "continuous", "base", "a") +
                                 joint("B", "fixed", "base", "b", "<mimic joint='A'/>")));
  EXPECT_FALSE(model.links[2].joint.mimic.has_value());
  EXPECT_THAT(to_string(model.report), HasSubstr("note: the <mimic> of a joint that doesn't move is ignored"));
}

TEST(UrdfLoader, AContinuousJointCanBeATrack) {
  for (const char* name : {"belt", "T"}) {  // the link, or its joint
    const std::string by_name = "<gazebo reference='" + std::string(name) +
                                "'><pseudo_continuous_track>true</pseudo_continuous_track></gazebo>";
    const Model model =
        load(robot(link("base") + link("wheel") + link("belt") + joint("T", "continuous", "base", "belt") +
                   joint("W", "continuous", "base", "wheel") + by_name));
    EXPECT_EQ(model.links[1].joint.type, JointType::track);
    EXPECT_EQ(model.links[1].joint.id, 0);  // it has a number among the joints
    EXPECT_EQ(model.links[2].joint.id, 1);
    EXPECT_EQ(model.report.size(), 0u) << to_string(model.report);
  }
}

TEST(UrdfLoader, TurnsATensorIntoTheLinksAxes) {
  const Model model =
      load(still("<inertial><origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><mass value='4'/>"
                 "<inertia ixx='1' ixy='0' ixz='0' iyy='2' iyz='0' izz='2.5'/></inertial>"));
  const Inertial& inertial = model.links[0].inertial;
  EXPECT_EQ(inertial.center, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(inertial.inertia.isApprox(Eigen::Vector3d(2, 1, 2.5).asDiagonal().toDenseMatrix()));
  EXPECT_EQ(inertial.inertia, inertial.inertia.transpose());
}

TEST(UrdfLoader, ReadsEveryShape) {
  const Model model =
      load(still("<collision name='b'><geometry><box size='1 2 3'/></geometry></collision>"
                 "<collision><geometry><sphere radius='4'/></geometry></collision>"
                 "<collision><geometry><cylinder radius='5' length='6'/></geometry></collision>"
                 "<collision><origin xyz='0 0 1'/><geometry><capsule radius='7' length='8'/></geometry></collision>"));
  const auto& shapes = model.links[0].collisions;
  ASSERT_EQ(shapes.size(), 4u);
  EXPECT_EQ(shapes[0].name, "b");
  EXPECT_EQ(std::get<Box>(shapes[0].geometry).size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(shapes[1].geometry).radius, 4);
  EXPECT_EQ(std::get<Cylinder>(shapes[2].geometry).length, 6);
  EXPECT_EQ(std::get<Capsule>(shapes[3].geometry).radius, 7);
  EXPECT_EQ(std::get<Capsule>(shapes[3].geometry).length, 8);
  EXPECT_EQ(shapes[3].pose.translation().z(), 1);
}

TEST(UrdfLoader, AFixedChildCarriesTheMassOfAMovingLink) {
  const std::string text =
      robot(link("world", "") + link("frame", "") + link("load") + joint("hinge", "continuous", "world", "frame") +
            joint("weld", "fixed", "frame", "load"));
  EXPECT_EQ(load(text).mass(), 2.0);
}

TEST(UrdfLoader, APointMassBesideAnotherIsABodyButNotAlone) {
  const std::string point =
      "<inertial><mass value='1'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial>";
  const auto weld = [](const char* name, const char* child, const char* where) {
    return joint(name, "fixed", "base", child, std::string("<origin xyz='") + where + "'/>");
  };
  const std::string three = link("base", point) + link("l", point) + link("r", point);
  load(robot(three + weld("a", "l", "1 0 0") + weld("b", "r", "0 1 0")), {.strict = true});  // a triangle
  const Model needle = load(robot(three + weld("a", "l", "1 0 0") + weld("b", "r", "2 0 0")));
  EXPECT_THAT(to_string(needle.report), HasSubstr("repair: moving link 'base' has mass but no inertia"));
}

std::string visual(const std::string& material) {
  return "<visual><geometry><sphere radius='1'/></geometry>" + material + "</visual>";
}

TEST(UrdfMaterials, ANameMayBeUsedBeforeItIsDefined) {
  const Model model = load(robot("<link name='world'>" + visual("<material name='sky'/>") + "</link>" +
                                 "<material name='sky'><color rgba='0 0 1 0.5'/></material>"));
  EXPECT_EQ(model.links[0].visuals[0].color, Color(0, 0, 1, 0.5f));
}

TEST(UrdfMaterials, AColourInAnyLinkDefinesItsName) {
  const Model model =
      load(still(visual("<material name='sky'/>") + visual("<material name='sky'><color rgba='0 0 1 1'/></material>") +
                 visual("<material name='sky'/>")));
  for (const Shape& shape : model.links[0].visuals) EXPECT_EQ(shape.color, Color(0, 0, 1, 1));
}

TEST(UrdfMaterials, TheLaterOfTwoColoursWinsForLaterUses) {
  const Model model =
      load(still(visual("<material name='m'><color rgba='1 0 0 1'/></material>") + visual("<material name='m'/>") +
                 visual("<material name='m'><color rgba='0 1 0 1'/></material>") + visual("<material name='m'/>")));
  const auto& visuals = model.links[0].visuals;
  EXPECT_EQ(visuals[1].color, Color(1, 0, 0, 1));
  EXPECT_EQ(visuals[2].color, Color(0, 1, 0, 1));
  EXPECT_EQ(visuals[3].color, Color(0, 1, 0, 1));
}

TEST(UrdfMaterials, TheEmptyNameBelongsToNobody) {
  const Model model = load(still(visual("<material name=''><color rgba='1 0 0 1'/></material>") +
                                 visual("<material name=''/>") + visual("")),
                           {.strict = true});
  EXPECT_EQ(model.links[0].visuals[0].color, Color(1, 0, 0, 1));
  EXPECT_FALSE(model.links[0].visuals[1].color);
  EXPECT_FALSE(model.links[0].visuals[2].color);
}

TEST(UrdfMaterials, TheSameColourTwiceIsOnlyNoted) {
  const std::string red = "<material name='m'><color rgba='1 0 0 1'/></material>";
  EXPECT_THAT(to_string(load(robot(red + red + link("world", "")), {.strict = true}).report),
              HasSubstr("note: a material defined again with the same colour is ignored"));
}

TEST(UrdfReport, CountsWhatIsIgnoredOnceAKind) {
  const Model model =
      load(robot("\n<mystery name='a'/>\n<mystery name='b'/>\n<link name='world'><visual><geometry><sphere radius='1'/>"
                 "</geometry></visual></link>\n<gazebo><plugin/></gazebo>\n<!-- said --> unsaid"));
  const std::string report = to_string(model.report);
  EXPECT_THAT(report, HasSubstr("test.urdf:2: note: <robot><mystery> is ignored, here and in 1 other places\n"));
  EXPECT_THAT(report, HasSubstr("test.urdf:5: note: <gazebo><plugin> is ignored\n"));
  EXPECT_THAT(report, HasSubstr("note: text between the elements of <robot> is ignored\n"));
}

TEST(UrdfReport, ListsTransmissionsInOneNote) {
  const auto transmission = [](const std::string& name, const std::string& more) {
    return "\n<transmission name='t'><type>SimpleTransmission</type><joint name='" + name +
           "'><hardwareInterface>EffortJointInterface</hardwareInterface></joint><actuator name='m'>" + more +
           "</actuator></transmission>";
  };
  const std::string two = transmission("hip", "<mechanicalReduction>1.0</mechanicalReduction>") +
                          transmission("knee", "<mechanicalReduction>50</mechanicalReduction>");
  EXPECT_EQ(to_string(load(robot(link("world", "") + two)).report),
            "test.urdf:2: note: 2 transmissions are passed over, commands go straight to the joints: 'hip' by "
            "EffortJointInterface; 'knee' by EffortJointInterface, reduction 50 without effect\n");
  std::string many;
  for (int i = 0; i < 10; ++i) many += "<transmission/>";
  EXPECT_THAT(to_string(load(robot(link("world", "") + many)).report), HasSubstr("no joint; no joint; and 2 more\n"));
}

TEST(UrdfReport, NotesThatSoftLimitsArentEnforced) {
  const std::string safe = "<safety_controller soft_lower_limit='-1' k_position='2'/>";
  const Model model = load(robot(link("base") + link("a") + link("b") + joint("A", "continuous", "base", "a", safe) +
                                 joint("B", "continuous", "base", "b", safe)));
  EXPECT_EQ(to_string(model.report),
            "test.urdf:1: note: a <safety_controller> isn't enforced, here and in 1 other places\n");
}

TEST(UrdfReport, StandsInDocumentOrder) {
  const Model model = load(robot("\n<mystery/>\n<link name='base'>" + std::string(some_inertial) +
                                 "</link>\n<link name='arm' color='red'>" + some_inertial + "</link>\n" +
                                 joint("hinge", "revolute", "base", "arm") + "\n<riddle/>"));
  std::vector<int> lines;
  for (const Diagnostic& each : model.report) lines.push_back(each.line);
  EXPECT_THAT(lines, ElementsAre(2, 4, 5, 6));
}

TEST(UrdfReport, KnowsTheLinesOfLinksJointsAndDevices) {
  const Model model =
      load(robot("\n" + link("world", "") + "\n" + link("arm") + "\n" + joint("hinge", "continuous", "world", "arm") +
                 "\n<gazebo reference='arm'>\n<sensor name='imu' type='imu'/></gazebo>"));
  EXPECT_EQ(model.links[0].line, 2);
  EXPECT_EQ(model.links[1].line, 3);
  EXPECT_EQ(model.links[1].joint.line, 4);
  EXPECT_EQ(model.devices[0].line, 6);
}

TEST(UrdfErrors, AreAllToldAtOnceInDocumentOrder) {
  const Result<Model> result =
      parse_urdf(robot("\n" + joint("j", "bolted", "world", "arm") +
                       "\n<link name='world'>\n<collision><geometry><cone/></geometry></collision></link>\n" +
                       link("arm", "<inertial><mass value='x'/></inertial>")),
                 "test.urdf");
  ASSERT_FALSE(result);
  std::vector<int> lines;
  for (const Diagnostic& each : result.errors()) lines.push_back(each.line);
  EXPECT_THAT(lines, ElementsAre(2, 4, 5));
}

TEST(UrdfErrors, AreTwentyAtMostAndSayHowManyMore) {
  std::string links;
  for (int i = 0; i < 50; ++i) links += "<link/>\n";
  const Result<Model> result = parse_urdf(robot(links), "test.urdf");
  ASSERT_FALSE(result);
  ASSERT_EQ(result.errors().size(), 21u);
  EXPECT_EQ(result.errors()[19].line, 20);
  EXPECT_EQ(result.errors()[20].severity, Severity::note);
  EXPECT_EQ(result.errors()[20].message, "30 more errors are not listed");
}

TEST(UrdfNumbers, MayHaveBlanksAroundAndASign) {
  const Model model =
      load(still("<inertial><origin xyz='\t1.\n+.5  -2E-3 '/><mass value=' 2 '/>"
                 "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='-0' izz='1'/></inertial>"));
  EXPECT_EQ(model.links[0].inertial.center, Eigen::Vector3d(1.0, 0.5, -0.002));
  EXPECT_EQ(model.links[0].inertial.mass, 2.0);
}

TEST(UrdfNumbers, AreNothingElse) {
  for (const char* number :
       {"", " ", "1 2", "0x10", "1e", "+-1", "--1", "nan", "inf", "1e999", "1,5", "1.5.2", "1_000", "①"}) {
    const std::string text =
        still("<collision><geometry><sphere radius='" + std::string(number) + "'/></geometry></collision>");
    EXPECT_THAT(refusal(text), HasSubstr("test.urdf:1: error: radius of <sphere> is")) << number;
  }
}

TEST(UrdfFile, IsKeptByteForByte) {
  const std::string text = robot("\r\n  <!-- as written -->" + link("world", ""));
  const Model model = load(text);
  EXPECT_EQ(model.source_text, text);
  EXPECT_EQ(model.source_file, "test.urdf");
}

TEST(UrdfFile, IsReadOnceForTheSameNameAndOptions) {
  const std::string text = still("<visual><geometry><sphere radius='0.123'/></geometry></visual>");
  const std::uint64_t before = urdf::robots_read();
  const Model first = load(text), second = load(text);
  EXPECT_EQ(urdf::robots_read(), before + 1);
  EXPECT_EQ(second.source_text, first.source_text);
  EXPECT_EQ(std::get<Sphere>(second.links[0].visuals[0].geometry).radius, 0.123);

  EXPECT_EQ(parse_urdf(text, "other.urdf")->source_file, "other.urdf");
  EXPECT_EQ(urdf::robots_read(), before + 2);
  EXPECT_EQ(load(text, {.fixed_root = true}).source_text, text);
  EXPECT_EQ(urdf::robots_read(), before + 3);
}

TEST(UrdfFile, IsReadAgainIfItNamesOtherFiles) {
  const std::string shape = "<visual><geometry><mesh filename='part.stl'/></geometry></visual>";
  const test::TemporaryFolder folder;
  const std::string name = (folder / "robot.urdf").string();
  const UrdfOptions lenient{.allow_missing_meshes = true};
  EXPECT_EQ(parse_urdf(still(shape), name, lenient)->links[0].visuals.size(), 0u);
  std::filesystem::copy_file(FIXTURES_DIR "/broken/meshes/triangle.stl", folder / "part.stl");
  EXPECT_EQ(parse_urdf(still(shape), name, lenient)->links[0].visuals.size(), 1u);
}

TEST(UrdfFile, OfManyIsForgottenAtLast) {
  const auto numbered = [](int i) { return still("<!-- " + std::to_string(i) + " -->"); };
  for (int i = 0; i < 100; ++i) load(numbered(i));
  const std::uint64_t before = urdf::robots_read();
  load(numbered(99));
  EXPECT_EQ(urdf::robots_read(), before);
  load(numbered(0));
  EXPECT_EQ(urdf::robots_read(), before + 1);
}

TEST(UrdfFile, SaysWhenItIsNotThereOrNotAFile) {
  EXPECT_EQ(to_string(load_urdf("no/such.urdf").errors()), "no/such.urdf: error: there is no such file\n");
  const std::string folder = FIXTURES_DIR;
  EXPECT_EQ(to_string(load_urdf(folder).errors()), folder + ": error: this is not a file that can be read\n");
}

TEST(UrdfFile, MayBeginWithAByteOrderMark) {
  EXPECT_EQ(load("\xEF\xBB\xBF<?xml version='1.0'?>" + robot(link("world", ""))).name, "test");
}

TEST(UrdfFixtures, WeighWhatTheirShapesWeigh) {
  const auto of = [](const char* file) {
    const Result<Model> model = load_urdf(std::string(FIXTURES_DIR "/models/") + file, {.strict = true});
    if (!model) throw std::runtime_error(to_string(model.errors()));
    const Link& body = model->links.back();
    const Inertial solid = solid_inertial(body.collisions.at(0).geometry, body.inertial.mass);
    EXPECT_TRUE(body.inertial.inertia.isApprox(solid.inertia, 1e-12)) << file << "\n" << solid.inertia;
    EXPECT_EQ(body.inertial.center, body.collisions.at(0).pose.translation()) << file;
  };
  of("pendulum.urdf");
  of("crate.urdf");
}

}  // namespace
}  // namespace rehearse
