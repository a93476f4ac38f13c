// A robot with a device of each kind, and the topics of its log: the input for tests of maps.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/urdf.h>

#include <string>
#include <vector>

#include "core/kinds/kinds.h"
#include "logs/map/log_topics.h"

namespace rehearse {

inline const char* const mapped_robot_urdf = R"(<robot name="Bot">
  <link name="BASE"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="ARM"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="HAND"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <link name="TOOL"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="SHOULDER" type="revolute">
    <parent link="BASE"/><child link="ARM"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="100" velocity="10"/>
  </joint>
  <joint name="ELBOW" type="continuous"><parent link="ARM"/><child link="HAND"/><axis xyz="0 1 0"/></joint>
  <joint name="MOUNT" type="fixed"><parent link="HAND"/><child link="TOOL"/></joint>
  <gazebo reference="BASE">
    <sensor name="Imu" type="imu"/>
    <sensor name="Gyro" type="gyroscope"/>
    <sensor name="Accel" type="accelerometer"/>
    <sensor name="Compass" type="magnetometer"/>
    <sensor name="Touch" type="contact"/>
    <sensor name="Camera" type="camera">
      <camera><image><width>8</width><height>6</height></image></camera>
    </sensor>
    <sensor name="Depth" type="depth_camera">
      <camera><image><width>8</width><height>6</height></image></camera>
    </sensor>
    <sensor name="Laser" type="ray">
      <ray>
        <scan><horizontal><samples>5</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
        <range><min>0.1</min><max>10</max></range>
      </ray>
    </sensor>
  </gazebo>
  <gazebo reference="HAND"><sensor name="Wrist" type="force_torque"/></gazebo>
</robot>
)";

inline Model mapped_robot() {
  Result<Model> model = parse_urdf(mapped_robot_urdf, "bot.urdf");
  REHEARSE_ASSERT(model.ok(), "the robot of the tests is a model");
  return *std::move(model);
}

template <class T>
LogTopic topic_with(const std::string& name) {
  const mcap::Schema schema{1, std::string(T::type_name), "ros2msg", msg::schema_text<T>()};
  return log_topic(name, "cdr", &schema);
}

inline LogTopic topic_with(const std::string& name, const std::string& type, const std::string& schema_text) {
  const mcap::Schema schema{1, type, "ros2msg", schema_text};
  return log_topic(name, "cdr", &schema);
}

inline std::vector<LogTopic> mapped_topics() {
  return {
      topic_with<msg::Image>("/camera/image_raw"),
      topic_with<msg::CompressedImage>("/camera/image_raw/compressed"),
      topic_with<msg::CameraInfo>("/camera/camera_info"),
      topic_with<msg::PointCloud2>("/cloud"),
      topic_with("/efforts", "std_msgs/msg/Float64MultiArray", "float64[] data\n"),
      topic_with<msg::WrenchStamped>("/ft_wrist"),
      topic_with<msg::Imu>("/imu/data"),
      topic_with<msg::JointState>("/joint_commands"),
      topic_with<msg::JointState>("/joint_states"),
      topic_with<msg::Joy>("/joy"),
      topic_with("/mag", "sensor_msgs/msg/MagneticField", form_of(ChannelKind::magnetic_field).schema()),
      topic_with("/mag/float", "robot_msgs/msg/Field",
                 "Axes magnetic_field\n====\nMSG: robot_msgs/Axes\nfloat32 x\nfloat32 y\nfloat32 z\n"),
      log_topic("/json", "json", nullptr),
      topic_with(
          "/odom", "nav_msgs/msg/Odometry",
          "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
          "====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
          "====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
          "====\nMSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n"
          "====\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"
          "====\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
          "====\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
          "====\nMSG: geometry_msgs/TwistWithCovariance\ngeometry_msgs/Twist twist\nfloat64[36] covariance\n"
          "====\nMSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"
          "====\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"),
      topic_with<msg::PoseStamped>("/pose"),
      topic_with("/rosout", "std_msgs/msg/String", "string data\n"),
      topic_with<msg::LaserScan>("/scan"),
      topic_with<msg::ContactForce>("/touch"),
  };
}

}  // namespace rehearse
