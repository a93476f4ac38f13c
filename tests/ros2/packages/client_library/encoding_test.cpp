// Messages as bytes.
#include <algorithm>
#include <rcl_interfaces/msg/parameter_value.hpp>
#include <sensor_msgs/msg/joint_state.hpp>

#include "client_library.h"

namespace {

TEST_F(ClientLibrary, EveryKindOfFieldIsDecodedAsItWasEncoded) {
  sensor_msgs::msg::JointState message;
  message.header.frame_id = "base";
  message.name = {"a", "", "hinge"};
  message.position = {1.0, -2.5};
  const auto& type = rehearse_ros2::members_of<sensor_msgs::msg::JointState>();
  std::vector<std::uint8_t> bytes;
  rehearse_ros2::encode(&message, type, bytes);
  sensor_msgs::msg::JointState decoded;
  rehearse_ros2::decode(bytes.data(), bytes.size(), type, &decoded);
  EXPECT_EQ(decoded, message);
  EXPECT_EQ(rehearse_ros2::type_name_of(type), "sensor_msgs/msg/JointState");
  EXPECT_NE(rehearse_ros2::definition_of(type).find("std_msgs/Header header\nstring[] name\n"), std::string::npos);
  rcl_interfaces::msg::ParameterValue value, decoded_value;
  value.bool_array_value = {true, false, true};
  value.integer_array_value = {-1, 1};
  const auto& value_type = rehearse_ros2::members_of<rcl_interfaces::msg::ParameterValue>();
  rehearse_ros2::encode(&value, value_type, bytes);
  rehearse_ros2::decode(bytes.data(), bytes.size(), value_type, &decoded_value);
  EXPECT_EQ(decoded_value, value);
}

TEST_F(ClientLibrary, BytesThatAreNoMessageAreRefused) {
  sensor_msgs::msg::JointState message;
  message.name = {"a", "b"};
  message.position = {1.0, 2.0};
  const auto& type = rehearse_ros2::members_of<sensor_msgs::msg::JointState>();
  std::vector<std::uint8_t> bytes;
  rehearse_ros2::encode(&message, type, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    sensor_msgs::msg::JointState decoded;
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(rehearse_ros2::decode(cut.data(), cut.size(), type, &decoded), rehearse_ros2::DecodingError) << size;
  }
  // A length of 4 billion takes no memory.
  for (std::size_t place = 4; place + 4 <= bytes.size(); ++place) {
    std::vector<std::uint8_t> changed = bytes;
    std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(place), 4, 0xff);
    sensor_msgs::msg::JointState decoded;
    try {
      rehearse_ros2::decode(changed.data(), changed.size(), type, &decoded);
    } catch (const rehearse_ros2::DecodingError&) {
    }
    EXPECT_LE(decoded.name.size() + decoded.position.size(), bytes.size());
  }
}

}  // namespace
