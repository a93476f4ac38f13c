// The kinds of devices of robots: sensors, lights and actuators that are no joints. A kind is a struct with its
// settings and its row, form(), which every part of Rehearse reads.
#pragma once

#include <rehearse/units.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rehearse {

inline constexpr double unlimited = std::numeric_limits<double>::infinity();

/// A quantity that a sensor or joint measures, as the noise of a scenario names it.
struct MeasuredQuantity {
  std::string_view name = {};
  UnitName unit = {};         // of a joint, that of one that turns
  int axes = 0;               // 3: x, y, z, each with a separate bias; 1: all numbers have the same noise
  UnitName linear_unit = {};  // of a joint that slides; empty: the quantity isn't one of joints
};

// The members of a DeviceForm have no default: a kind of device that leaves one out doesn't compile.

/// Names of a kind of device in one sort of file.
class DeviceNames {
 public:
  struct None {};
  constexpr DeviceNames(None) {}
  constexpr DeviceNames(const char* first, const char* second = "", const char* third = "", const char* fourth = "")
      : names_{first, second, third, fourth} {}

  constexpr bool has(std::string_view name) const {
    for (const std::string_view each : names_)
      if (!name.empty() && each == name) return true;
    return false;
  }
  constexpr std::string_view first() const { return names_[0]; }

 private:
  std::array<std::string_view, 4> names_;
};

/// The quantities that a kind of device measures.
class DeviceQuantities {
 public:
  struct None {};
  constexpr DeviceQuantities(None) {}
  constexpr DeviceQuantities(const MeasuredQuantity& first, const MeasuredQuantity& second = {})
      : quantities_{first, second} {}

  constexpr const std::array<MeasuredQuantity, 2>& all() const { return quantities_; }  // some without a name

 private:
  std::array<MeasuredQuantity, 2> quantities_;
};

/// When a kind of device measures, and how many numbers.
class DeviceReadings {
 public:
  /// Numbers of each step: a function of LinkSensor gives them, or the forces of the step.
  static constexpr DeviceReadings each_step(int values) { return {values, false}; }
  /// Pictures or ranges at a rate of the device's own.
  static constexpr DeviceReadings captures() { return {0, false}; }
  /// None: a controller commands the device.
  static constexpr DeviceReadings none() { return {0, true}; }

  constexpr int values() const { return values_; }
  constexpr bool acts() const { return acts_; }

 private:
  constexpr DeviceReadings(int values, bool acts) : values_(values), acts_(acts) {}
  int values_;
  bool acts_;
};

/// What all devices of a kind have in common.
struct DeviceForm {
  std::string_view type;  // their name for controllers
  DeviceReadings readings;
  DeviceQuantities quantities;
  DeviceNames scenario_types;  // of a sensor in a scenario
  DeviceNames urdf_types;      // of a <sensor> in a URDF, if the type is all of it
  DeviceNames body_types;      // of an element in a .body file, if type and place are all of it

  /// Of a kind that a controller commands and that measures nothing.
  static constexpr DeviceForm acting(std::string_view type) {
    return {.type = type,
            .readings = DeviceReadings::none(),
            .quantities = DeviceQuantities::None(),
            .scenario_types = DeviceNames::None(),
            .urdf_types = DeviceNames::None(),
            .body_types = DeviceNames::None()};
  }
};

struct ForceSensor {
  static constexpr DeviceForm form() {
    return {.type = "ForceSensor",
            .readings = DeviceReadings::each_step(6),
            .quantities = {{"force", "N", 3}, {"torque", "N·m", 3}},
            .scenario_types = {"force"},
            .urdf_types = {"force_torque"},
            .body_types = {"ForceSensor"}};
  }
};

struct Gyro {
  static constexpr DeviceForm form() {
    return {.type = "RateGyroSensor",
            .readings = DeviceReadings::each_step(3),
            .quantities = {{"angular_velocity", "rad/s", 3}},
            .scenario_types = {"gyro"},
            .urdf_types = {"gyroscope", "gyro"},
            .body_types = {"RateGyroSensor"}};
  }
};

struct Accelerometer {
  static constexpr DeviceForm form() {
    return {.type = "AccelerationSensor",
            .readings = DeviceReadings::each_step(3),
            .quantities = {{"acceleration", "m/s²", 3}},
            .scenario_types = {"accelerometer"},
            .urdf_types = {"accelerometer"},
            .body_types = {"AccelerationSensor"}};
  }
};

struct Imu {
  static constexpr DeviceForm form() {
    return {.type = "Imu",
            .readings = DeviceReadings::each_step(6),
            .quantities = {{"angular_velocity", "rad/s", 3}, {"acceleration", "m/s²", 3}},
            .scenario_types = {"imu"},
            .urdf_types = {"imu"},
            .body_types = {"IMU", "Imu"}};
  }
};

/// The time in which light makes a picture. A row is exposed for `time`, from its beginning on; the picture shows the
/// mean light of `frames` moments that lie evenly in it, each as the tick in which it lies. Rows begin from the top one
/// after the other: row r of H at the capture plus readout * r / H.
struct Exposure {
  static constexpr int most_frames = 64;
  double time = 0.0;     // [s]; 0: a moment
  int frames = 8;        // of each row, 1 to most_frames
  double readout = 0.0;  // [s]; 0: all rows begin together

  bool is_instant() const { return time <= 0.0 && readout <= 0.0; }
};

/// A pinhole camera. It looks along its device frame's -z with +y up (the convention of OpenGL and of Choreonoid).
struct Camera {
  int width = 640;                  // [pixels]
  int height = 480;                 // [pixels]
  double field_of_view = 0.785398;  // [rad]: vertical if width >= height, else horizontal
  double near_clip = 0.04;          // [m]
  double far_clip = 200.0;          // [m]
  double frame_rate = 30.0;         // [Hz] of simulated time
  bool depth = false;               // the camera also measures depth (a RangeCamera)
  bool shadows = false;             // the sun casts shadows in its pictures
  bool antialiasing = false;        // edges in its pictures are smooth
  Exposure exposure = {};           // it ends before the picture arrives; depth is that of the capture

  constexpr DeviceForm form() const {
    const MeasuredQuantity color{"color", "of 255", 1}, distance{"depth", "m", 1};
    return {.type = depth ? "RangeCamera" : "Camera",
            .readings = DeviceReadings::captures(),
            .quantities = depth ? DeviceQuantities(color, distance) : DeviceQuantities(color),
            .scenario_types = depth ? "depth" : "camera",
            .urdf_types = DeviceNames::None(),
            .body_types = DeviceNames::None()};
  }
};

/// One direction of a range sensor's grid: evenly spaced beams from the lower to the upper angle, both included. For a
/// single beam both angles are equal.
struct Sweep {
  double lower = 0.0;  // [rad]
  double upper = 0.0;  // [rad]
  int samples = 1;

  double step() const { return samples > 1 ? (upper - lower) / (samples - 1) : 0.0; }  // [rad]
  double angle(int sample) const { return lower + sample * step(); }                   // [rad]
};

/// A laser scanner: a grid of beams from its origin. Straight ahead is its device frame's -z, with +y up; yaw turns
/// about +y, left is positive; then pitch about +x, up is positive (the convention of Choreonoid). Beams are numbered
/// row by row from the lowest pitch, within a row from the lowest yaw: the right-most comes first.
struct RangeSensor {
  Sweep yaw;
  Sweep pitch;
  double min_distance = 0.1;   // beams pass through nearer shapes [m]
  double max_distance = 10.0;  // beams end here [m]
  double scan_rate = 10.0;     // [Hz] of simulated time

  int beams() const { return yaw.samples * pitch.samples; }
  static constexpr DeviceForm form() {
    return {.type = "RangeSensor",
            .readings = DeviceReadings::captures(),
            .quantities = {{"range", "m", 1}},
            .scenario_types = {"range"},
            .urdf_types = {"ray", "gpu_ray", "lidar", "gpu_lidar"},
            .body_types = DeviceNames::None()};
  }
};

/// The cone of a spot light. Angles are measured from the direction.
struct LightCone {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  // in the device frame; of any length but 0
  float beam_width = 1.570796f;                           // the light has its full strength up to this angle [rad]
  float cut_off_angle = 0.785398f;                        // no light beyond this angle [rad]
  float cut_off_exponent = 1.0f;                          // stored for controllers; no picture depends on it
};

/// A lamp that shines into pictures, from its device frame's origin. At a distance d [m] its light is divided by
/// constant + linear * d + quadratic * d². The values are float because the controller interface uses float.
///
/// The state of a light as numbers: on (1 or 0), red, green, blue, intensity, constant, linear, quadratic; for a spot
/// also direction x, y, z, beam width, cut-off angle, cut-off exponent.
struct Light {
  bool on = true;
  Eigen::Vector3f color = Eigen::Vector3f::Ones();  // red, green, blue, 0 to 1
  float intensity = 1.0f;                           // multiplied with the colour
  float constant = 1.0f;
  float linear = 0.0f;            // [1/m]
  float quadratic = 0.0f;         // [1/m²]
  double range = unlimited;       // no light beyond this distance [m]
  std::optional<LightCone> cone;  // nullopt: the light shines in all directions

  constexpr DeviceForm form() const { return DeviceForm::acting(cone ? "SpotLight" : "PointLight"); }
};

/// Measures whether its link touches anything. In each step it measures four numbers: the number of contact points, and
/// the sum of the forces on the link at these points, x, y, z in the device frame [N].
struct ContactSensor {
  int collision = -1;  // the only shape whose contacts count, an index into the link's collisions; -1: all shapes

  static constexpr DeviceForm form() {
    return {.type = "ContactSensor",
            .readings = DeviceReadings::each_step(4),
            .quantities = {{"force", "N", 3}},
            .scenario_types = {"contact"},
            .urdf_types = {"contact"},
            .body_types = DeviceNames::None()};
  }
};

/// Measures the magnetic field of the world at its place, x, y, z in the device frame [T]. Choreonoid has no such
/// device.
struct Magnetometer {
  static constexpr DeviceForm form() {
    return {.type = "Magnetometer",
            .readings = DeviceReadings::each_step(3),
            .quantities = {{"magnetic_field", "T", 3}},
            .scenario_types = {"magnetometer"},
            .urdf_types = {"magnetometer"},
            .body_types = {"Magnetometer"}};
  }
};

/// A propeller, as Choreonoid's RotorDevice. A controller commands its thrust F [N] and its torque M [N·m]; it pushes
/// its link with F d at its place and turns it with M d, where d is its direction. A turned-off rotor does neither.
struct Rotor {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // in the device frame, unit length

  static constexpr DeviceForm form() { return DeviceForm::acting("RotorDevice"); }
};

/// A gripper that holds a link while it is on, as Choreonoid's HolderDevice. It takes hold in the first step in which
/// the condition is met, of one link of another body, and lets go when it is turned off.
struct Holder {
  enum class Condition {
    distance,  // the link's origin is at most max_distance away; of several the nearest
    touch,     // the link touches the holder's own link
    name,      // it is the root link of the body named `target`, at any distance
  };
  Condition condition = Condition::distance;
  double max_distance = 0.1;  // from the device's place [m]
  std::string target;         // the name of a body

  static constexpr DeviceForm form() { return DeviceForm::acting("HolderDevice"); }
};

using DeviceKind = std::variant<ForceSensor, Gyro, Accelerometer, Imu, Camera, RangeSensor, Light, ContactSensor, Rotor,
                                Holder, Magnetometer>;

/// A sensor or light fixed to a link. Models list them in document order, stably sorted by link.
struct Device {
  std::string name;
  int id = -1;                                             // as in the file; -1 if the file gives none
  int link = 0;                                            // index into Model::links
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // device frame in the link frame; see the kind for its axes
  DeviceKind kind;
  int line = 0;  // of the model's file; 0: the file doesn't contain this device
};

/// DeviceForm::type: "ForceSensor", "Camera", ...
std::string_view type_name(const Device& device);

/// All kinds of devices; a camera twice, without depth and with.
std::vector<DeviceKind> device_kinds();

/// DeviceForm::scenario_types: "imu"; empty: no sensor of a scenario.
std::string_view scenario_type(const DeviceKind& kind);

/// The kind of a <sensor> of this type in a URDF; nullopt: none, or one that needs more than its type (cameras).
std::optional<DeviceKind> device_kind_of_urdf(std::string_view type);
/// The kind of an element of this type in a .body file, if the type is all of it; nullopt: none.
std::optional<DeviceKind> device_kind_of_body(std::string_view type);

/// The quantities that a device measures.
std::vector<MeasuredQuantity> quantities_of(const Device& device);

/// Returns `light` with the state given by `values` (see Light), or unchanged if there are too few values.
Light light_of_state(Light light, const std::vector<double>& values);

/// The number of values that a device measures in each step (see DeviceReading). It is 0 for devices that don't measure
/// in each step (cameras, range sensors) or measure nothing (lights, rotors, holders).
int value_count(const Device& device);

/// True for devices that only act: lights, rotors and holders.
bool is_actuator(const Device& device);

/// Unit vectors along the beams, in the sensor's device frame and in the order of their numbers.
std::vector<Eigen::Vector3d> beam_directions(const RangeSensor& sensor);

}  // namespace rehearse
