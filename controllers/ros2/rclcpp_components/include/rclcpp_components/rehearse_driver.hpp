// A component that isn't a node: it drives the robot in each tick, and has nodes of its own.
#pragma once

#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

struct rehearse_io;  // of <rehearse/controller.h>

namespace rehearse_ros2 {

/// What a scenario states about a driver.
struct DriverOptions {
  std::vector<std::string> arguments;        // of its node, without the files of parameters
  std::vector<std::string> parameter_files;  // for its node and its controllers
  std::string description;                   // a file of URDF
  std::vector<std::string> controllers;      // to be active from the beginning
  std::vector<std::string> others;           // that an event activates
};

/// All functions throw std::exception, whose text is a sentence about the failure.
class RobotDriver {
 public:
  virtual ~RobotDriver() = default;
  /// Names what it reads and commands. `io` is valid as long as the driver.
  virtual void initialize(rehearse_io* io, const DriverOptions& options) = 0;
  /// After initialize(): what calls its nodes.
  virtual std::shared_ptr<rclcpp::Executor> executor() = 0;
  /// After initialize(): the full names of its nodes, first that of its own.
  virtual std::vector<std::string> nodes() const = 0;
  /// Once a tick, when messages have been delivered.
  virtual void control() = 0;
  /// Before control() of the tick in which it happens. `is_strict`: all or nothing.
  virtual void switch_controllers(const std::vector<std::string>& activate, const std::vector<std::string>& deactivate,
                                  bool is_strict) = 0;
};

}  // namespace rehearse_ros2
