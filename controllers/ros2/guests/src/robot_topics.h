// The topics that are parts of the robot.
#pragma once

#include <rehearse/controller.h>

#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "guest_options.h"

namespace rehearse::ros2 {

/// A topic that the robot publishes.
class RobotSource {
 public:
  virtual ~RobotSource() = default;
  virtual void publish() = 0;
};
/// Names what is read. Throws OptionsError.
std::unique_ptr<RobotSource> make_source(const TopicBinding& binding, rehearse_io* io, rclcpp::Node& robot);

/// A kind of commands: a row of a table.
struct CommandRow;

/// A topic by which the robot is commanded.
class RobotSink {
 public:
  /// Names what is commanded. Throws OptionsError.
  RobotSink(const TopicBinding& binding, rehearse_io* io);
  /// Takes part in the topic as soon as somebody publishes on it. Throws OptionsError if its type has no commands.
  void connect();
  /// Commands what the last message says since the last call.
  void command();

 private:
  struct Joint {
    std::string name;
    int handle = 0;
  };
  void set(const Joint& joint, double value);
  TopicBinding binding_;
  rehearse_io* io_;
  const CommandRow& row_;
  std::vector<Joint> joints_;
  std::shared_ptr<rehearse_ros2::Endpoint> endpoint_;
};

}  // namespace rehearse::ros2
