#include "rclcpp_action/rclcpp_action.hpp"

namespace rclcpp_action {

std::string to_string(const GoalUUID& id) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : id) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

GoalUUID rehearse_next_id() {
  GoalUUID id{};
  auto number = static_cast<std::uint64_t>(rehearse_ros2::Bus::instance().next_number());
  for (std::size_t place = id.size(); number != 0; number >>= 8) id[--place] = static_cast<std::uint8_t>(number);
  return id;
}

void RehearseMail::post(int order, std::function<void()> work) {
  {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    work_[order].push_back(std::move(work));
  }
  rehearse_ros2::Bus::instance().notify();
}

bool RehearseMail::rehearse_ready(std::int64_t) { return !work_.empty(); }

void RehearseMail::rehearse_execute() {
  std::function<void()> work;
  {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    const auto first = work_.begin();
    if (first == work_.end()) return;
    work = std::move(first->second.front());
    first->second.pop_front();
    if (first->second.empty()) work_.erase(first);
  }
  work();
}

void ServerGoalHandleBase::go_to(std::int8_t status) {
  const std::int8_t now = status_;
  const bool is_executing = now == GoalStatus::STATUS_EXECUTING, is_canceling = now == GoalStatus::STATUS_CANCELING;
  bool is_allowed = false;
  switch (status) {
    case GoalStatus::STATUS_EXECUTING: is_allowed = now == GoalStatus::STATUS_ACCEPTED; break;
    case GoalStatus::STATUS_CANCELING: is_allowed = now == GoalStatus::STATUS_ACCEPTED || is_executing; break;
    case GoalStatus::STATUS_CANCELED: is_allowed = is_canceling; break;
    default: is_allowed = is_executing || is_canceling; break;
  }
  if (!is_allowed)
    throw rclcpp::exceptions::RCLError("goal_handle attempted invalid transition from state " + std::to_string(now) +
                                       " to " + std::to_string(status));
  status_ = status;
}

std::map<std::string, std::weak_ptr<ServerBase>>& rehearse_servers() {
  static std::map<std::string, std::weak_ptr<ServerBase>> servers;
  return servers;
}

}  // namespace rclcpp_action
