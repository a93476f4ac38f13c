// The messages of a trace: plain structs with the names and fields of ROS 2.
//
// Each struct lists its fields once, in for_each_field(). encode(), decode() and the schema text use this list, so they
// always agree. encode() and decode() don't allocate once strings and vectors have reached their size. The package
// rehearse_msgs belongs to this project; harness/TRACE_FORMAT.md describes its types.
#pragma once

#include <rehearse/cdr.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::msg {

/// In a recording: simulated time since its start.
struct Time {
  static constexpr std::string_view type_name = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;

  /// From nanoseconds, as log times are.
  static Time from_ns(std::uint64_t ns) {
    return {static_cast<std::int32_t>(ns / 1'000'000'000), static_cast<std::uint32_t>(ns % 1'000'000'000)};
  }
  std::uint64_t to_ns() const { return static_cast<std::uint64_t>(sec) * 1'000'000'000 + nanosec; }

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("sec", self.sec);
    visit("nanosec", self.nanosec);
  }
};

struct Header {
  static constexpr std::string_view type_name = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;  // the frame of the quantities

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("frame_id", self.frame_id);
  }
};

struct Vector3 {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Vector3";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
};

/// [m]
struct Point {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Point";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
  }
};

struct Quaternion {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Quaternion";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
    visit("w", self.w);
  }
};

struct Pose {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("position", self.position);
    visit("orientation", self.orientation);
  }
};

struct Twist {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Twist";
  Vector3 linear;   // [m/s]
  Vector3 angular;  // [rad/s]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("linear", self.linear);
    visit("angular", self.angular);
  }
};

struct Accel {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Accel";
  Vector3 linear;   // [m/s²]
  Vector3 angular;  // [rad/s²]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("linear", self.linear);
    visit("angular", self.angular);
  }
};

struct Wrench {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Wrench";
  Vector3 force;   // [N]
  Vector3 torque;  // [N·m]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("force", self.force);
    visit("torque", self.torque);
  }
};

struct Transform {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Transform";
  Vector3 translation;  // [m]
  Quaternion rotation;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("translation", self.translation);
    visit("rotation", self.rotation);
  }
};

/// The pose of the frame child_frame_id in the header's frame.
struct TransformStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("child_frame_id", self.child_frame_id);
    visit("transform", self.transform);
  }
};

struct PoseStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("pose", self.pose);
  }
};

struct TwistStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TwistStamped";
  Header header;
  Twist twist;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("twist", self.twist);
  }
};

struct AccelStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/AccelStamped";
  Header header;
  Accel accel;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("accel", self.accel);
  }
};

struct WrenchStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/WrenchStamped";
  Header header;
  Wrench wrench;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("wrench", self.wrench);
  }
};

struct TFMessage {
  static constexpr std::string_view type_name = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("transforms", self.transforms);
  }
};

/// Each array is empty or as long as `name`. NaN: not given for this joint.
struct JointState {
  static constexpr std::string_view type_name = "sensor_msgs/msg/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;  // [rad] or [m]
  std::vector<double> velocity;  // [rad/s] or [m/s]
  std::vector<double> effort;    // [N·m] or [N]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("name", self.name);
    visit("position", self.position);
    visit("velocity", self.velocity);
    visit("effort", self.effort);
  }
};

/// A covariance whose first element is -1: the quantity is not measured.
struct Imu {
  static constexpr std::string_view type_name = "sensor_msgs/msg/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity;  // [rad/s]
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;  // [m/s²]
  std::array<double, 9> linear_acceleration_covariance{};

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("orientation", self.orientation);
    visit("orientation_covariance", self.orientation_covariance);
    visit("angular_velocity", self.angular_velocity);
    visit("angular_velocity_covariance", self.angular_velocity_covariance);
    visit("linear_acceleration", self.linear_acceleration);
    visit("linear_acceleration_covariance", self.linear_acceleration_covariance);
  }
};

struct Image {
  static constexpr std::string_view type_name = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;  // [pixels]
  std::uint32_t width = 0;   // [pixels]
  std::string encoding;      // as rgb8, 32FC1
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // bytes per row
  std::vector<std::uint8_t> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("encoding", self.encoding);
    visit("is_bigendian", self.is_bigendian);
    visit("step", self.step);
    visit("data", self.data);
  }
};

struct CompressedImage {
  static constexpr std::string_view type_name = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;  // as png
  std::vector<std::uint8_t> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("format", self.format);
    visit("data", self.data);
  }
};

struct RegionOfInterest {
  static constexpr std::string_view type_name = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("x_offset", self.x_offset);
    visit("y_offset", self.y_offset);
    visit("height", self.height);
    visit("width", self.width);
    visit("do_rectify", self.do_rectify);
  }
};

/// The matrices are by rows; see the ROS documentation of the type.
struct CameraInfo {
  static constexpr std::string_view type_name = "sensor_msgs/msg/CameraInfo";
  Header header;
  std::uint32_t height = 0;  // [pixels]
  std::uint32_t width = 0;   // [pixels]
  std::string distortion_model;
  std::vector<double> d;       // distortion
  std::array<double, 9> k{};   // intrinsics [pixels]
  std::array<double, 9> r{};   // rectification
  std::array<double, 12> p{};  // projection [pixels]
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("distortion_model", self.distortion_model);
    visit("d", self.d);
    visit("k", self.k);
    visit("r", self.r);
    visit("p", self.p);
    visit("binning_x", self.binning_x);
    visit("binning_y", self.binning_y);
    visit("roi", self.roi);
  }
};

/// The state of a joystick. The joystick's driver defines the numbers of axes and buttons.
struct Joy {
  static constexpr std::string_view type_name = "sensor_msgs/msg/Joy";
  Header header;
  std::vector<float> axes;
  std::vector<std::int32_t> buttons;  // 1 while pressed

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("axes", self.axes);
    visit("buttons", self.buttons);
  }
};

/// Distances in one plane; angles increase to the left, about the frame's +z from its +x.
struct LaserScan {
  static constexpr std::string_view type_name = "sensor_msgs/msg/LaserScan";
  Header header;                 // stamped with the time of the scan
  float angle_min = 0.0f;        // [rad]
  float angle_max = 0.0f;        // [rad]
  float angle_increment = 0.0f;  // [rad]
  float time_increment = 0.0f;   // between beams [s]
  float scan_time = 0.0f;        // between scans [s]
  float range_min = 0.0f;        // [m]
  float range_max = 0.0f;        // [m]
  std::vector<float> ranges;     // [m]; +inf: nothing was found
  std::vector<float> intensities;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("angle_min", self.angle_min);
    visit("angle_max", self.angle_max);
    visit("angle_increment", self.angle_increment);
    visit("time_increment", self.time_increment);
    visit("scan_time", self.scan_time);
    visit("range_min", self.range_min);
    visit("range_max", self.range_max);
    visit("ranges", self.ranges);
    visit("intensities", self.intensities);
  }
};

/// One quantity of each point of a PointCloud2.
struct PointField {
  static constexpr std::string_view type_name = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t float32 = 7;
  std::string name;
  std::uint32_t offset = 0;   // offset in the point [bytes]
  std::uint8_t datatype = 0;  // float32 in recordings
  std::uint32_t count = 0;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("name", self.name);
    visit("offset", self.offset);
    visit("datatype", self.datatype);
    visit("count", self.count);
  }
};

struct PointCloud2 {
  static constexpr std::string_view type_name = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;  // rows
  std::uint32_t width = 0;   // points per row
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;  // bytes per point
  std::uint32_t row_step = 0;    // bytes per row
  std::vector<std::uint8_t> data;
  bool is_dense = false;  // every point is valid

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("height", self.height);
    visit("width", self.width);
    visit("fields", self.fields);
    visit("is_bigendian", self.is_bigendian);
    visit("point_step", self.point_step);
    visit("row_step", self.row_step);
    visit("data", self.data);
    visit("is_dense", self.is_dense);
  }
};

/// One per tick: hashes by which two runs are compared quickly.
struct Tick {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Tick";
  Time stamp;
  std::int64_t tick = 0;
  std::uint64_t state_hash = 0;          // hash of the complete simulation state at the beginning of the tick
  std::uint64_t input_hash = 0;          // hash of all inputs of controllers
  std::uint64_t output_hash = 0;         // hash of all commands of controllers
  std::vector<bool> controller_results;  // the results of control(), in scenario order

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("tick", self.tick);
    visit("state_hash", self.state_hash);
    visit("input_hash", self.input_hash);
    visit("output_hash", self.output_hash);
    visit("controller_results", self.controller_results);
  }
};

/// The numbers of a device for which ROS has no message type.
struct DeviceState {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/DeviceState";
  Header header;
  std::vector<double> values;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("values", self.values);
  }
};

/// A point where a link touches an object, in the frame of the message that contains it.
struct Contact {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Contact";
  Point position;
  Vector3 normal;    // from the other object into the link, unit length
  Vector3 force;     // force of the other object on the link [N]
  Vector3 velocity;  // velocity of the link's point relative to the other object's point [m/s]
  double depth = 0;  // depth of the overlap [m]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("position", self.position);
    visit("normal", self.normal);
    visit("force", self.force);
    visit("velocity", self.velocity);
    visit("depth", self.depth);
  }
};

/// All contacts of a link.
struct Contacts {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Contacts";
  Header header;
  std::vector<Contact> contacts;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("contacts", self.contacts);
  }
};

/// The measurement of a contact sensor.
struct ContactForce {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ContactForce";
  Header header;
  std::uint32_t count = 0;  // number of contact points
  Vector3 force;            // force on the link, sum over all points [N]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("count", self.count);
    visit("force", self.force);
  }
};

/// Both arrays have the same length. NaN: the joint has no value.
struct JointAccelerations {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/JointAccelerations";
  Header header;
  std::vector<std::string> name;
  std::vector<double> acceleration;  // [rad/s²] or [m/s²]

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("header", self.header);
    visit("name", self.name);
    visit("acceleration", self.acceleration);
  }
};

/// A single event: a controller failed, a push began.
struct Event {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Event";
  Time stamp;
  std::int64_t tick = 0;
  std::string severity;  // note, warning or error
  std::string source;    // as SR1/SR1Minimum
  std::string text;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("tick", self.tick);
    visit("severity", self.severity);
    visit("source", self.source);
    visit("text", self.text);
  }
};

/// Two links begin or end to touch.
struct ContactChange {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ContactChange";
  Time stamp;
  std::int64_t tick = 0;  // tick after the step in which it happened
  std::string link;       // as SR1/RLEG_ANKLE_R
  std::string other;
  bool begins = false;  // true: the contact begins; false: it ends

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("tick", self.tick);
    visit("link", self.link);
    visit("other", self.other);
    visit("begins", self.begins);
  }
};

/// The complete state of the simulation, from which a run can continue.
struct Checkpoint {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Checkpoint";
  Time stamp;
  std::int64_t tick = 0;
  std::string format;  // name and version of the layout of data
  std::vector<std::uint8_t> data;

  template <class Self, class Visit>
  static void for_each_field(Self& self, Visit&& visit) {
    visit("stamp", self.stamp);
    visit("tick", self.tick);
    visit("format", self.format);
    visit("data", self.data);
  }
};

}  // namespace rehearse::msg
