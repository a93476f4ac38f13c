// Types of actions.
#pragma once

#include <action_msgs/msg/goal_info.hpp>
#include <action_msgs/msg/goal_status.hpp>
#include <action_msgs/msg/goal_status_array.hpp>
#include <action_msgs/srv/cancel_goal.hpp>
#include <rclcpp/rclcpp.hpp>

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <ostream>
#include <string>

namespace rclcpp_action {

using GoalUUID = std::array<std::uint8_t, 16>;
using GoalStatus = action_msgs::msg::GoalStatus;
using GoalInfo = action_msgs::msg::GoalInfo;

enum class GoalResponse : std::int8_t { REJECT = 1, ACCEPT_AND_EXECUTE = 2, ACCEPT_AND_DEFER = 3 };
enum class CancelResponse : std::int8_t { REJECT = 1, ACCEPT = 2 };
enum class ResultCode : std::int8_t {
  UNKNOWN = GoalStatus::STATUS_UNKNOWN,
  SUCCEEDED = GoalStatus::STATUS_SUCCEEDED,
  CANCELED = GoalStatus::STATUS_CANCELED,
  ABORTED = GoalStatus::STATUS_ABORTED
};
std::string to_string(const GoalUUID& id);
inline std::ostream& operator<<(std::ostream& out, ResultCode code) { return out << static_cast<int>(code); }
/// Counted, not random, so that it is the same in each run.
GoalUUID rehearse_next_id();

namespace exceptions {

class UnknownGoalHandleError : public std::invalid_argument {
 public:
  UnknownGoalHandleError() : std::invalid_argument("Goal handle is not known to this client.") {}
};
class UnawareGoalHandleError : public std::runtime_error {
 public:
  explicit UnawareGoalHandleError(const std::string& text = "Goal handle is not tracking the goal result.")
      : std::runtime_error(text) {}
};

}  // namespace exceptions

/// Work that waits for an executor, in order of its class, and of its arrival.
class RehearseMail : public rclcpp::Waitable {
 public:
  void post(int order, std::function<void()> work);
  bool rehearse_ready(std::int64_t) override;
  void rehearse_execute() override;

 private:
  std::map<int, std::deque<std::function<void()>>> work_;  // under the lock of the bus
};

}  // namespace rclcpp_action
