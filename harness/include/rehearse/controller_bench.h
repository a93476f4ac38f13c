// ControllerBench: one controller under test, without physics and without a recording. A test sets the inputs of the
// controller, makes a tick, and reads its commands.
//
//   rehearse::ControllerBench bench("MyWalker", "models/walker.urdf");
//   bench.joint("ANKLE").q = 0.1;                    // [rad]
//   bench.tick();
//   EXPECT_NEAR(bench.joint("ANKLE").u, 12.0, 1e-9);  // [N·m]
//   bench.axis("L_STICK_V") = -1.0;                   // a person pushes the stick forward
//
// A value that a test doesn't set stays constant. Joints, links and sensors are at rest at the pose of the options;
// commands move nothing. The controller sees only quantities that it enabled in initialize(), which runs in the
// constructor. C++17. Functions throw std::out_of_range for a name that the model doesn't have; the message
// begins with the line of the call, and lists similar names.
#pragma once

#include <rehearse/call_place.h>
#include <rehearse/faults.h>
#include <rehearse/io.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The inputs of a joint, set before a tick, and its commands, read after the tick.
struct BenchJoint {
  double q = 0.0;    // input of the controller: displacement [rad] or [m]
  double dq = 0.0;   // [rad/s] or [m/s]
  double ddq = 0.0;  // [rad/s²] or [m/s²]
  /// Before a tick the effort of the last step, after a tick the commanded effort, if any, under the faults of the
  /// options [N·m] or [N].
  double u = 0.0;
  double q_target = 0.0;   // commanded [rad] or [m]
  double dq_target = 0.0;  // commanded [rad/s] or [m/s]
};

/// A point where a link touches something, in the world.
struct BenchContact {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // from the other object into the link, unit length
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // exerted by the other object on the link [N]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the link's point relative to the other object's point [m/s]
  double depth = 0.0;                                  // depth of the overlap [m]
};

/// A link, in the world frame. The rotation is a unit quaternion; it isn't aligned, so that no compiler option changes
/// the layout.
struct BenchLink {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  /// From the link's frame to the world's.
  Eigen::Quaternion<double, Eigen::DontAlign> rotation = Eigen::Quaternion<double, Eigen::DontAlign>::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              // [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // [m/s²]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // [rad/s²]
  std::vector<BenchContact> contacts;                              // kept until the test sets them again
  Eigen::Vector3d force = Eigen::Vector3d::Zero();                 // commanded external force [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // commanded external torque about the world's origin [N·m]
};

/// A sensor with values measures in every tick. A camera delivers a picture in the tick after the test set it.
struct BenchDevice {
  /// In the device frame. Force sensor: force [N], torque [N·m] (6 numbers); gyro: angular velocity [rad/s] (3);
  /// accelerometer: specific force [m/s²] (3); IMU: angular velocity, specific force (6); contact sensor: number of
  /// points, force [N] (4); range sensor: distances [m], one per beam, which the controller gets rounded to float.
  /// Empty: no measurement.
  std::vector<double> values;
  std::shared_ptr<const Image> image;       // of a camera; null: no picture
  std::shared_ptr<const DepthImage> depth;  // of a RangeCamera [m]; null: no distances
  bool on = true;                           // set by the controller
};

/// The settings and the initial state of a bench.
struct BenchOptions {
  double time_step = 0.001;              // [s]
  std::string options;                   // the controller's option string
  std::map<std::string, double> joints;  // displacement at the beginning, by name [rad] or [m]; 0 for all others
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the root link at the beginning [m]
  bool joystick = true;                                // true: a joystick is connected, at rest until the test moves it
  Faults faults;                                       // of sensors, encoders and actuators; none by default
};

/// A controller with a robot whose inputs a test sets and whose commands it reads, tick by tick, without physics.
class ControllerBench {
 public:
  /// `library`: a controller's name or path, `model`: a URDF or .body file; paths are relative to the test's fixtures.
  /// Runs configure(), initialize() and start(). Throws std::runtime_error if something can't be loaded, or if the
  /// controller refuses or fails.
  ControllerBench(const std::string& library, const std::string& model, const BenchOptions& options = {},
                  const CallPlace& from = CallPlace::here());
  ~ControllerBench();
  ControllerBench(const ControllerBench&) = delete;
  ControllerBench& operator=(const ControllerBench&) = delete;

  /// Inputs and commands of a joint. Throws std::out_of_range if the robot has none of this name.
  BenchJoint& joint(std::string_view name, const CallPlace& from = CallPlace::here());
  /// Inputs and commands of a link; throws likewise.
  BenchLink& link(std::string_view name, const CallPlace& from = CallPlace::here());
  /// The reading of a device; throws likewise.
  BenchDevice& device(std::string_view name, const CallPlace& from = CallPlace::here());

  // The joystick, by the names (or the numbers) that a scenario uses. A value stays until it is set again. They throw
  // std::logic_error if BenchOptions::joystick is false.
  double& axis(std::string_view name,
               const CallPlace& from =
                   CallPlace::here());  // -1 to 1, up and left negative; triggers 0 to 1; rounded to single precision
  bool& button(std::string_view name, const CallPlace& from = CallPlace::here());  // pressed

  /// Computes the poses of all links, at rest, from the root link's pose and the joints' q. Their contacts do not
  /// change.
  void update_links();

  /// Copies inputs, calls control(), reads outputs, and advances the time by one step. Returns the result of control().
  /// Throws std::runtime_error if the controller throws, crashes or hangs; with REHEARSE_REALTIME=1 in the environment
  /// also if a tick after the first one isn't real-time safe. Throws std::invalid_argument if a sensor has
  /// a wrong number of values, or if an axis is out of its range.
  bool tick(const CallPlace& from = CallPlace::here());

  /// Time that the controller sees in the next tick [s].
  double time() const;
  std::int64_t ticks() const;  // number of ticks so far

  /// The last value that the controller set for a variable (rehearse_variable.h). std::out_of_range if it never set it.
  double variable(std::string_view name, const CallPlace& from = CallPlace::here()) const;

  /// What the last tick's control() cost: "allocations", "allocated_bytes", "releases", "locks", "system_calls",
  /// "exceptions" or "message_bytes". Throws std::out_of_range for another name, std::runtime_error if costs can't be
  /// counted here.
  std::uint64_t cost(std::string_view name, const CallPlace& from = CallPlace::here()) const;
  /// Why control() isn't real-time safe after the first tick, with the counts; empty: it is. EXPECT_REALTIME (gtest.h)
  /// tests it.
  std::string realtime_problem() const;

  /// Lines that the controller wrote to its stream, and remarks about it, since the beginning.
  const std::vector<std::string>& messages() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
