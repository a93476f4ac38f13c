// Observation and Command: all data that controllers read from a robot in one tick, and all data that they write to it.
//
// This is the only boundary between robot and controllers. World produces an Observation and takes a Command; a
// recording contains both; a replay feeds recorded Observations to the same code and compares Commands. An Observation
// contains everything that a controller can read of a robot and of the joystick. Values are in the world frame unless
// stated otherwise, in SI units. C++17, because tests of controllers include it.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace rehearse {

// Camera images, as the renderer draws them and controllers read them. Row 0 is the top row.

/// A colour image: three bytes per pixel (red, green, blue), rows from the top, no padding.
struct Image {
  int width = 0;                     // [pixels]
  int height = 0;                    // [pixels]
  std::vector<std::uint8_t> pixels;  // width * height * 3
  std::vector<std::uint8_t> file{};  // the JPEG or PNG from which the pixels were decoded; empty: none
};

/// Distance along the camera's optical axis [m] for each pixel, rows from the top; +inf where there is no surface.
struct DepthImage {
  int width = 0;              // [pixels]
  int height = 0;             // [pixels]
  std::vector<float> meters;  // width * height
};

/// Rounds distances to the resolution of a depth camera: 13 significant bits, an error of at most 1/16384 of the
/// distance (at 1 m: 0.06 mm). The lower bits come from the rasteriser, not from the scene, and would make up most of
/// a recording.
void round_to_resolution(DepthImage& depth);

// A joystick is a gamepad, with the axes and buttons that Choreonoid numbers, in its order.

inline constexpr std::array<std::string_view, 8> joystick_axes{"L_STICK_H", "L_STICK_V",         "R_STICK_H",
                                                               "R_STICK_V", "DIRECTIONAL_PAD_H", "DIRECTIONAL_PAD_V",
                                                               "L_TRIGGER", "R_TRIGGER"};
inline constexpr std::array<std::string_view, 11> joystick_buttons{"A",      "B",     "X",       "Y",       "L",   "R",
                                                                   "SELECT", "START", "L_STICK", "R_STICK", "LOGO"};

/// The state of a joystick at one moment. By default nothing is moved or pressed. Axes have single precision, as in
/// ROS messages, so the recorded value is exactly the value that was read.
struct JoystickReading {
  std::array<float, joystick_axes.size()> axes{};       // -1 to 1, up and left negative; triggers 0 to 1
  std::array<bool, joystick_buttons.size()> buttons{};  // true while pressed

  friend bool operator==(const JoystickReading& left, const JoystickReading& right) {
    return left.axes == right.axes && left.buttons == right.buttons;
  }
};

/// The lowest value of an axis; the highest is 1.
constexpr double lowest_position(std::size_t axis) {
  return joystick_axes[axis].find("_TRIGGER") < joystick_axes[axis].size() ? 0.0 : -1.0;
}

/// The index of an axis (of joystick_axes) or a button (of joystick_buttons) by its name or its number, "1" or
/// "L_STICK_V"; nullopt if there is none.
template <std::size_t N>
std::optional<std::size_t> find_control(const std::array<std::string_view, N>& names, std::string_view name) {
  for (std::size_t i = 0; i < N; ++i)
    if (name == names[i] || name == std::to_string(i)) return i;
  return std::nullopt;
}

struct JointReading {
  double q = 0.0;    // displacement [rad] or [m]; a revolute joint's angle is unwrapped
  double dq = 0.0;   // [rad/s] or [m/s]
  double ddq = 0.0;  // [rad/s²] or [m/s²], difference of dq over the last step
  double u = 0.0;    // effort applied in the last step [N·m] or [N]
};

/// Motion of a link frame's origin. The rotation is a unit quaternion: a controller's matrix is always made from it,
/// live and in replay, so that both see the same bits.
struct LinkReading {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              // [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // [m/s²]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // [rad/s²]
};

/// The pose with that position [m] and rotation, a unit quaternion.
inline Eigen::Isometry3d pose_of(const Eigen::Vector3d& position, const Eigen::Quaterniond& rotation) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.toRotationMatrix();
  pose.translation() = position;
  return pose;
}

/// The pose of the link's frame.
inline Eigen::Isometry3d pose_of(const LinkReading& link) { return pose_of(link.position, link.rotation); }

/// The last measurement of a device, and whether it is new since the last tick.
/// `values` by kind: ForceSensor force [N] then torque about the sensor's origin [N·m]; Gyro angular velocity [rad/s];
/// Accelerometer specific force [m/s²]; Imu angular velocity then specific force; ContactSensor number of points, then
/// force on the link [N]; all in the device frame.
/// A camera has pictures and no values, a range sensor has ranges and no values.
struct DeviceReading {
  bool fresh = false;        // new since the last tick
  double measured_at = 0.0;  // time of the measurement [s]; of a camera or range sensor: of its capture
  std::vector<double> values;
  std::shared_ptr<const Image> image;                // null until the first frame
  std::shared_ptr<const DepthImage> depth;           // null unless the camera measures depth
  std::shared_ptr<const std::vector<float>> ranges;  // by beam [m], +inf for none; null until the first scan
};

/// A point where a link touched another shape in the last step. All vectors are in world axes.
struct ContactReading {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    // from the other shape into the link, unit length
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // of the other shape on the link [N]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the link's point relative to the other shape's [m/s]
  double depth = 0.0;                                  // how far the two shapes overlap [m]
};

/// Two links that touch. The link of the earlier body comes first; within one body the earlier link comes first.
struct LinkPair {
  int body = 0;  // index into the world's bodies
  int link = 0;  // index into its model's links
  int other_body = 0;
  int other_link = 0;

  static LinkPair of(int body, int link, int other_body, int other_link) {
    const bool in_order = std::pair(body, link) <= std::pair(other_body, other_link);
    return in_order ? LinkPair{body, link, other_body, other_link} : LinkPair{other_body, other_link, body, link};
  }
  auto all() const { return std::tie(body, link, other_body, other_link); }
  friend bool operator==(const LinkPair& left, const LinkPair& right) { return left.all() == right.all(); }
  friend bool operator<(const LinkPair& left, const LinkPair& right) { return left.all() < right.all(); }
};

/// What the actuator of a joint did in the last step. Controllers don't read it.
struct ActuatorReading {
  double q = 0.0;       // displacement of the rotor, as it acts at the joint [rad] or [m]
  double dq = 0.0;      // [rad/s] or [m/s]
  double wanted = 0.0;  // effort of the motor before its limits [N·m] or [N]
  double effort = 0.0;  // after them
  double thermal_limit = std::numeric_limits<double>::infinity();  // of efforts, while it is hot
};

/// Force and torque, the torque about the world's origin.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // [N·m]
};

struct BodyObservation {
  std::vector<JointReading> joints;                   // by joint id
  std::vector<LinkReading> links;                     // by link index
  std::vector<DeviceReading> devices;                 // by device index
  std::vector<std::vector<ContactReading>> contacts;  // by link index; empty if no link is watched (World::watch)
  std::vector<ActuatorReading> actuators = {};        // by joint id; empty: the body has none
  std::vector<Wrench> external = {};                  // as controllers read it, by link index; empty: none
};

/// The state at the beginning of a tick.
struct Observation {
  std::vector<BodyObservation> bodies;      // in scenario order
  std::optional<JoystickReading> joystick;  // one for all controllers; nullopt: no joystick
};

/// The quantity that drives a joint. The values are bits, so that they can be combined later.
enum Drive : std::uint8_t {
  drive_none = 0,
  drive_effort = 1,        // u
  drive_displacement = 2,  // q
  drive_velocity = 4,      // dq
};

struct JointCommand {
  std::uint8_t drive = drive_none;
  double q = 0.0;   // wanted displacement [rad] or [m]
  double dq = 0.0;  // wanted velocity [rad/s] or [m/s]
  double u = 0.0;   // effort [N·m] or [N]
};

/// A controller's command to a device. It has an effect only if it is fresh.
struct DeviceCommand {
  bool fresh = false;
  bool on = true;
  std::vector<double> values;  // the device's whole state, as cnoid's writeState() gives it; for lights see Light
};

/// The commanded pose of a link's frame in the world.
struct LinkPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// The commanded velocities of a link, in world axes.
struct LinkTwist {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // of its origin [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s]
};

/// The motion of a link that no joint guides, at the end of the coming step and whatever acts on it. The place counts
/// before the twist.
struct GivenMotion {
  std::optional<LinkPlace> place;
  std::optional<LinkTwist> twist;
};

struct BodyCommand {
  std::vector<JointCommand> joints;    // by joint id
  std::map<int, GivenMotion> given;    // by link index: of the root, and of links behind free joints
  std::vector<Wrench> external;        // by link index
  std::vector<DeviceCommand> devices;  // by device index
};

struct Command {
  std::vector<BodyCommand> bodies;  // in scenario order
};

}  // namespace rehearse
