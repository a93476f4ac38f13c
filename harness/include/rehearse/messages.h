// The messages of a trace: plain structs with the names and fields of ROS 2.
//
// Each struct lists its fields once, in REHEARSE_FIELDS (cdr.h). encode(), decode() and the schema text use this list,
// so they always agree. encode() and decode() don't allocate once strings and vectors have reached their size. The
// package rehearse_msgs belongs to this project; harness/TRACE_FORMAT.md describes its types.
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
  REHEARSE_FIELDS(sec, nanosec)

  /// From nanoseconds, as log times are.
  static Time from_ns(std::uint64_t ns) {
    return {static_cast<std::int32_t>(ns / 1'000'000'000), static_cast<std::uint32_t>(ns % 1'000'000'000)};
  }
  std::uint64_t to_ns() const { return static_cast<std::uint64_t>(sec) * 1'000'000'000 + nanosec; }
};

struct Header {
  static constexpr std::string_view type_name = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;  // the frame of the quantities
  REHEARSE_FIELDS(stamp, frame_id)
};

struct Vector3 {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Vector3";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  REHEARSE_FIELDS(x, y, z)
};

/// [m]
struct Point {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Point";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  REHEARSE_FIELDS(x, y, z)
};

struct Quaternion {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Quaternion";
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;
  REHEARSE_FIELDS(x, y, z, w)
};

struct Pose {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;
  REHEARSE_FIELDS(position, orientation)
};

struct Twist {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Twist";
  Vector3 linear;   // [m/s]
  Vector3 angular;  // [rad/s]
  REHEARSE_FIELDS(linear, angular)
};

struct Accel {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Accel";
  Vector3 linear;   // [m/s²]
  Vector3 angular;  // [rad/s²]
  REHEARSE_FIELDS(linear, angular)
};

struct Wrench {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Wrench";
  Vector3 force;   // [N]
  Vector3 torque;  // [N·m]
  REHEARSE_FIELDS(force, torque)
};

struct Transform {
  static constexpr std::string_view type_name = "geometry_msgs/msg/Transform";
  Vector3 translation;  // [m]
  Quaternion rotation;
  REHEARSE_FIELDS(translation, rotation)
};

/// The pose of the frame child_frame_id in the header's frame.
struct TransformStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;
  REHEARSE_FIELDS(header, child_frame_id, transform)
};

struct PoseStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;
  REHEARSE_FIELDS(header, pose)
};

struct TwistStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/TwistStamped";
  Header header;
  Twist twist;
  REHEARSE_FIELDS(header, twist)
};

struct AccelStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/AccelStamped";
  Header header;
  Accel accel;
  REHEARSE_FIELDS(header, accel)
};

struct WrenchStamped {
  static constexpr std::string_view type_name = "geometry_msgs/msg/WrenchStamped";
  Header header;
  Wrench wrench;
  REHEARSE_FIELDS(header, wrench)
};

struct TFMessage {
  static constexpr std::string_view type_name = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
  REHEARSE_FIELDS(transforms)
};

/// Each array is empty or as long as `name`. NaN: not given for this joint.
struct JointState {
  static constexpr std::string_view type_name = "sensor_msgs/msg/JointState";
  Header header;
  std::vector<std::string> name;
  std::vector<double> position;  // [rad] or [m]
  std::vector<double> velocity;  // [rad/s] or [m/s]
  std::vector<double> effort;    // [N·m] or [N]
  REHEARSE_FIELDS(header, name, position, velocity, effort)
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
  REHEARSE_FIELDS(header, orientation, orientation_covariance, angular_velocity, angular_velocity_covariance,
                  linear_acceleration, linear_acceleration_covariance)
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
  REHEARSE_FIELDS(header, height, width, encoding, is_bigendian, step, data)
};

struct CompressedImage {
  static constexpr std::string_view type_name = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;  // as png
  std::vector<std::uint8_t> data;
  REHEARSE_FIELDS(header, format, data)
};

struct RegionOfInterest {
  static constexpr std::string_view type_name = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;
  REHEARSE_FIELDS(x_offset, y_offset, height, width, do_rectify)
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
  REHEARSE_FIELDS(header, height, width, distortion_model, d, k, r, p, binning_x, binning_y, roi)
};

/// A number, as the value of a controller's variable.
struct Float64 {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64";
  double data = 0.0;
  REHEARSE_FIELDS(data)
};

/// The state of a joystick. The joystick's driver defines the numbers of axes and buttons.
struct Joy {
  static constexpr std::string_view type_name = "sensor_msgs/msg/Joy";
  Header header;
  std::vector<float> axes;
  std::vector<std::int32_t> buttons;  // 1 while pressed
  REHEARSE_FIELDS(header, axes, buttons)
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
  REHEARSE_FIELDS(header, angle_min, angle_max, angle_increment, time_increment, scan_time, range_min, range_max,
                  ranges, intensities)
};

/// One quantity of each point of a PointCloud2.
struct PointField {
  static constexpr std::string_view type_name = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t float32 = 7;
  std::string name;
  std::uint32_t offset = 0;   // offset in the point [bytes]
  std::uint8_t datatype = 0;  // float32 in recordings
  std::uint32_t count = 0;
  REHEARSE_FIELDS(name, offset, datatype, count)
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
  REHEARSE_FIELDS(header, height, width, fields, is_bigendian, point_step, row_step, data, is_dense)
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
  REHEARSE_FIELDS(stamp, tick, state_hash, input_hash, output_hash, controller_results)
};

/// The costs of a call of control(): the calls made by it, on its thread. Calls by Rehearse's own code don't count.
struct ControlCost {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ControlCost";
  Time stamp;
  std::uint64_t allocations = 0;      // malloc() and similar functions, and so operator new
  std::uint64_t allocated_bytes = 0;  // as requested [B]
  std::uint64_t releases = 0;         // free(), and so operator delete, of a block
  std::uint64_t locks = 0;            // functions that take a lock or wait for another thread
  std::uint64_t system_calls = 0;     // functions of the C library that call the system, or may do so
  std::uint64_t exceptions = 0;       // exceptions thrown
  std::uint64_t message_bytes = 0;    // written to os() [B]
  REHEARSE_FIELDS(stamp, allocations, allocated_bytes, releases, locks, system_calls, exceptions, message_bytes)
};

/// The numbers of a device for which ROS has no message type.
struct DeviceState {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/DeviceState";
  Header header;
  std::vector<double> values;
  REHEARSE_FIELDS(header, values)
};

/// A point where a link touches an object, in the frame of the message that contains it.
struct Contact {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Contact";
  Point position;
  Vector3 normal;    // from the other object into the link, unit length
  Vector3 force;     // force of the other object on the link [N]
  Vector3 velocity;  // velocity of the link's point relative to the other object's point [m/s]
  double depth = 0;  // depth of the overlap [m]
  REHEARSE_FIELDS(position, normal, force, velocity, depth)
};

/// All contacts of a link.
struct Contacts {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Contacts";
  Header header;
  std::vector<Contact> contacts;
  REHEARSE_FIELDS(header, contacts)
};

/// The measurement of a contact sensor.
struct ContactForce {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ContactForce";
  Header header;
  std::uint32_t count = 0;  // number of contact points
  Vector3 force;            // force on the link, sum over all points [N]
  REHEARSE_FIELDS(header, count, force)
};

/// Both arrays have the same length. NaN: the joint has no value.
struct JointAccelerations {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/JointAccelerations";
  Header header;
  std::vector<std::string> name;
  std::vector<double> acceleration;  // [rad/s²] or [m/s²]
  REHEARSE_FIELDS(header, name, acceleration)
};

/// A single event: a controller failed, a push began.
struct Event {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Event";
  Time stamp;
  std::int64_t tick = 0;
  std::string severity;  // note, warning or error
  std::string source;    // as SR1/SR1Minimum
  std::string text;
  REHEARSE_FIELDS(stamp, tick, severity, source, text)
};

/// True if the source of the observations reported the event, the world or a log, and no controller or its host.
inline bool is_of_observations(const Event& event) { return event.source == "world" || event.source == "log"; }

/// Two links begin or end to touch.
struct ContactChange {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/ContactChange";
  Time stamp;
  std::int64_t tick = 0;  // tick after the step in which it happened
  std::string link;       // as SR1/RLEG_ANKLE_R
  std::string other;
  bool begins = false;  // true: the contact begins; false: it ends
  REHEARSE_FIELDS(stamp, tick, link, other, begins)
};

/// The complete state of the simulation, from which a run can continue.
struct Checkpoint {
  static constexpr std::string_view type_name = "rehearse_msgs/msg/Checkpoint";
  Time stamp;
  std::int64_t tick = 0;
  std::string format;  // name and version of the layout of data
  std::vector<std::uint8_t> data;
  REHEARSE_FIELDS(stamp, tick, format, data)
};

}  // namespace rehearse::msg
