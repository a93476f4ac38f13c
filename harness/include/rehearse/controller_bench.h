// ControllerBench: one controller on a bench. No physics, no recording: a test sets what the controller reads, lets a
// tick pass, and looks at what it commands.
//
//   rehearse::ControllerBench bench("MyWalker", "models/walker.urdf");
//   bench.joint("ANKLE").q = 0.1;                    // [rad]
//   bench.tick();
//   EXPECT_NEAR(bench.joint("ANKLE").u, 12.0, 1e-9);  // [N·m]
//   bench.axis("L_STICK_V") = -1.0;                   // a person pushes the stick forward
//
// What a test doesn't set stays: joints, links and sensors are at rest where the options put them, and nothing moves by
// itself, whatever is commanded. The controller sees only what it enabled in initialize(), which runs in the
// constructor. C++17. Functions throw std::out_of_range for a name that the model hasn't, and say which names are near.
#pragma once

#include <rehearse/image.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// Set before a tick, read after it.
struct BenchJoint {
  double q = 0.0;         // what the controller reads: displacement [rad] or [m]
  double dq = 0.0;        // [rad/s] or [m/s]
  double ddq = 0.0;       // [rad/s²] or [m/s²]
  double u = 0.0;         // before a tick the effort of the last step, after it the commanded one, if any [N·m] or [N]
  double q_target = 0.0;  // commanded [rad] or [m]
  double dq_target = 0.0;  // commanded [rad/s] or [m/s]
};

/// A point where a link touches something, in the world.
struct BenchContact {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // from the other one into the link, unit length
  Eigen::Vector3d force = Eigen::Vector3d::Zero();     // of the other one on the link [N]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // of the link's point relative to the other's [m/s]
  double depth = 0.0;                                  // how far they overlap [m]
};

/// World frame. The rotation is a unit quaternion; it isn't aligned, so that no compiler option changes the layout.
struct BenchLink {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
  Eigen::Quaternion<double, Eigen::DontAlign> rotation = Eigen::Quaternion<double, Eigen::DontAlign>::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();              // [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // [m/s²]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // [rad/s²]
  std::vector<BenchContact> contacts;                              // held until they are set anew
  Eigen::Vector3d force = Eigen::Vector3d::Zero();                 // commanded external force [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // commanded external torque about the world's origin [N·m]
};

/// A sensor with values measures afresh in every tick; a camera delivers a picture in the tick after it was set.
struct BenchDevice {
  /// In the device frame. Force sensor: force [N], torque [N·m] (6 numbers); gyro: angular velocity [rad/s] (3);
  /// accelerometer: specific force [m/s²] (3); IMU: angular velocity, specific force (6); contact sensor: number of
  /// points, force [N] (4); range sensor: distances [m], one a beam, which the controller gets rounded to float. Empty:
  /// it measures nothing.
  std::vector<double> values;
  std::shared_ptr<const Image> image;
  std::shared_ptr<const DepthImage> depth;
  bool on = true;  // as the controller switched it
};

struct BenchOptions {
  double time_step = 0.001;              // [s]
  std::string options;                   // the controller's option string
  std::map<std::string, double> joints;  // displacement at the beginning, by name [rad] or [m]; 0 for all others
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // of the root link at the beginning [m]
  bool joystick = true;                                // there is one; nobody touches it until the test does
};

class ControllerBench {
 public:
  /// `library`: a controller's name or path, `model`: a URDF file; paths are relative to the test's fixtures. Runs
  /// configure(), initialize() and start(). Throws std::runtime_error if something can't be loaded, or if the
  /// controller refuses or fails.
  ControllerBench(const std::string& library, const std::string& model, const BenchOptions& options = {});
  ~ControllerBench();
  ControllerBench(const ControllerBench&) = delete;
  ControllerBench& operator=(const ControllerBench&) = delete;

  BenchJoint& joint(std::string_view name);
  BenchLink& link(std::string_view name);
  BenchDevice& device(std::string_view name);

  // The joystick, by the names (or the numbers) that a scenario uses. What is set is held. std::logic_error if the
  // options say that there is none.
  double& axis(std::string_view name);  // -1 to 1, up and left negative; triggers 0 to 1; rounded to single precision
  bool& button(std::string_view name);  // pressed

  /// Puts all links where the root link's pose and the joints' q say; at rest. Their contacts stay as they are.
  void update_links();

  /// Inputs, control(), outputs; then time advances by one step. Returns what control() returned. Throws
  /// std::runtime_error if the controller throws, crashes or hangs, std::invalid_argument if a sensor has a wrong
  /// number of values, or an axis is where it can't be.
  bool tick();

  /// Time that the controller sees in the next tick [s].
  double time() const;
  std::int64_t ticks() const;  // that have passed

  /// The value that the controller last gave a variable (rehearse_variable.h). std::out_of_range if it never set it.
  double variable(std::string_view name) const;

  /// What the controller wrote to its stream, and what was remarked on it, since the beginning.
  const std::vector<std::string>& messages() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
