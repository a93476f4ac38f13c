// Messages of several types that have the joints of a robot, or numbers for them.
#include <gmock/gmock.h>

#include <cmath>

#include "logs/bag/standard_types.h"
#include "logs/robot_log/joint_messages.h"
#include "logs/robot_log/number_messages.h"

namespace rehearse {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

ros2msg::Schema schema_of(const std::string& type, const std::string& text) {
  auto schema = ros2msg::Schema::parse(type, text);
  EXPECT_TRUE(schema) << to_string(schema.errors());
  return *std::move(schema);
}
ros2msg::Schema standard(const std::string& type) { return schema_of(type, bag::standard_definition(type).value()); }

void put_header(CdrWriter& cdr) {
  cdr.put(std::int32_t{1});
  cdr.put(std::uint32_t{2});
  cdr.put(std::string_view("base"));
}
void put_names(CdrWriter& cdr, const std::vector<std::string>& names) {
  cdr.put(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.put(std::string_view(name));
}
void put_point(CdrWriter& cdr, const std::vector<double>& positions, const std::vector<double>& effort) {
  cdr.put_sequence(std::span<const double>(positions));
  cdr.put(std::uint32_t{0});  // velocities
  cdr.put(std::uint32_t{0});  // accelerations
  cdr.put_sequence(std::span<const double>(effort));
  cdr.put(std::int32_t{0});
  cdr.put(std::uint32_t{0});
}

TEST(JointMessages, ReadAJointStateWhoseFieldsHaveAnotherOrder) {
  JointMessages reader(schema_of("a/msg/State", "float64[] effort\nstring[] name\nfloat64[] position\n"),
                       JointRole::measured);
  for (const double value : {0.5, 0.75}) {
    CdrWriter cdr;
    cdr.put_sequence(std::span<const double>(std::vector<double>{7}));
    put_names(cdr, {"A"});
    cdr.put_sequence(std::span<const double>(std::vector<double>{value}));
    const auto read = reader.read(cdr.bytes());
    ASSERT_TRUE(read);
    EXPECT_THAT((*read)->names(), ElementsAre("A"));
    EXPECT_THAT((*read)->position(), ElementsAre(value));
    EXPECT_THAT((*read)->velocity(), IsEmpty());
    EXPECT_THAT((*read)->effort(), ElementsAre(7));
    EXPECT_EQ((*read)->layout_changed(), value == 0.5);
  }
}

TEST(JointMessages, ReadATrajectoryOfOnePoint) {
  JointMessages reader(standard("trajectory_msgs/msg/JointTrajectory"), JointRole::commanded);
  CdrWriter cdr;
  put_header(cdr);
  put_names(cdr, {"A", "B"});
  cdr.put(std::uint32_t{1});
  put_point(cdr, {0.5, -1.5}, {7, 8});
  const auto read = reader.read(cdr.bytes());
  ASSERT_TRUE(read);
  const JointArrays* state = *read;
  EXPECT_THAT(state->names(), ElementsAre("A", "B"));
  EXPECT_THAT(state->position(), ElementsAre(0.5, -1.5));
  EXPECT_THAT(state->velocity(), IsEmpty());
  EXPECT_THAT(state->effort(), ElementsAre(7, 8));
}

TEST(JointMessages, DoNotReadATrajectoryOfSeveralPoints) {
  JointMessages reader(standard("trajectory_msgs/msg/JointTrajectory"), JointRole::commanded);
  CdrWriter cdr;
  put_header(cdr);
  put_names(cdr, {"A"});
  cdr.put(std::uint32_t{2});
  put_point(cdr, {0.5}, {});
  put_point(cdr, {0.6}, {});
  const auto read = reader.read(cdr.bytes());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.errors()[0].message, "a trajectory of 2 points, which states no single set of values");
}

TEST(JointMessages, NameTheJointWhoseInterfacesHaveOtherNumbersOfValues) {
  JointMessages reader(standard("control_msgs/msg/DynamicJointState"), JointRole::measured);
  CdrWriter cdr;
  put_header(cdr);
  put_names(cdr, {"A"});
  cdr.put(std::uint32_t{1});
  put_names(cdr, {"effort", "position"});
  cdr.put_sequence(std::span<const double>(std::vector<double>{3}));
  const auto read = reader.read(cdr.bytes());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.errors()[0].message, "1 values of 2 interfaces of joint 'A'");
}

TEST(JointMessages, ReadTheInterfacesOfADynamicJointState) {
  JointMessages reader(standard("control_msgs/msg/DynamicJointState"), JointRole::measured);
  CdrWriter cdr;
  put_header(cdr);
  put_names(cdr, {"A", "B"});
  cdr.put(std::uint32_t{2});
  put_names(cdr, {"effort", "position"});
  cdr.put_sequence(std::span<const double>(std::vector<double>{3, 0.25}));
  put_names(cdr, {"position", "temperature"});
  cdr.put_sequence(std::span<const double>(std::vector<double>{0.75, 40}));
  const auto read = reader.read(cdr.bytes());
  ASSERT_TRUE(read);
  const JointArrays* state = *read;
  EXPECT_THAT(state->position(), ElementsAre(0.25, 0.75));
  EXPECT_THAT(state->velocity(), IsEmpty());
  ASSERT_EQ(state->effort().size(), 2u);
  EXPECT_EQ(state->effort()[0], 3.0);
  EXPECT_TRUE(std::isnan(state->effort()[1]));
}

TEST(JointMessages, ReadAControllersStateByItsRole) {
  const std::string point =
      "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n"
      "builtin_interfaces/Duration time_from_start\n";
  for (const auto& [measured, commanded] : {std::pair("feedback", "reference"), {"actual", "desired"}}) {
    const ros2msg::Schema schema =
        schema_of("control_msgs/msg/JointTrajectoryControllerState",
                  std::string("std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint ") +
                      commanded + "\ntrajectory_msgs/JointTrajectoryPoint " + measured +
                      "\n====\nMSG: trajectory_msgs/JointTrajectoryPoint\n" + point);
    CdrWriter cdr;
    put_header(cdr);
    put_names(cdr, {"A"});
    put_point(cdr, {1}, {});
    put_point(cdr, {2}, {});
    EXPECT_THAT(JointMessages(schema, JointRole::commanded).read(cdr.bytes()).value()->position(), ElementsAre(1));
    EXPECT_THAT(JointMessages(schema, JointRole::measured).read(cdr.bytes()).value()->position(), ElementsAre(2));
  }
}

TEST(NumberMessages, BeginAtTheOffsetOfTheLayout) {
  NumberMessages reader(standard("std_msgs/msg/Float64MultiArray"));
  CdrWriter cdr;
  cdr.put(std::uint32_t{1});  // dimensions
  cdr.put(std::string_view("joint"));
  cdr.put(std::uint32_t{2});
  cdr.put(std::uint32_t{2});
  cdr.put(std::uint32_t{1});  // data_offset
  cdr.put_sequence(std::span<const double>(std::vector<double>{9, 1, 2}));
  const std::vector<double>* numbers = reader.read(cdr.bytes());
  ASSERT_NE(numbers, nullptr);
  EXPECT_THAT(*numbers, ElementsAre(1, 2));
}

TEST(NumberMessages, OfATwistAreItsSixNumbers) {
  for (const char* type : {"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"}) {
    NumberMessages reader(standard(type));
    CdrWriter cdr;
    if (std::string_view(type).ends_with("Stamped")) put_header(cdr);
    for (const double number : {1, 2, 3, 4, 5, 6}) cdr.put(number);
    const std::vector<double>* numbers = reader.read(cdr.bytes());
    ASSERT_NE(numbers, nullptr) << type;
    EXPECT_THAT(*numbers, ElementsAre(1, 2, 3, 4, 5, 6));
  }
}

}  // namespace
}  // namespace rehearse
