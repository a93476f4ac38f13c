// The server of an action. It takes goals first, then cancellations.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rclcpp_action/types.hpp"

namespace rclcpp_action {

class ServerGoalHandleBase {
 public:
  virtual ~ServerGoalHandleBase() = default;
  bool is_active() const { return status_ <= GoalStatus::STATUS_CANCELING && status_ > GoalStatus::STATUS_UNKNOWN; }
  bool is_executing() const { return status_ == GoalStatus::STATUS_EXECUTING; }
  bool is_canceling() const { return status_ == GoalStatus::STATUS_CANCELING; }

 protected:
  /// Throws rclcpp::exceptions::RCLError if the goal can't go from its status to this one.
  void go_to(std::int8_t status);
  std::atomic<std::int8_t> status_{GoalStatus::STATUS_ACCEPTED};
};

/// What a server tells the client of a goal.
struct GoalListener {
  std::function<void(std::shared_ptr<const void> feedback)> on_feedback;
  std::function<void(std::int8_t status, std::shared_ptr<void> result)> on_end;
  std::function<void(std::int8_t status)> on_status;
};

template <class Action>
class ServerGoalHandle : public ServerGoalHandleBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(ServerGoalHandle)
  using Goal = typename Action::Goal;
  using Result = typename Action::Result;
  using Feedback = typename Action::Feedback;
  ServerGoalHandle(const GoalUUID& id, std::shared_ptr<const Goal> goal, GoalListener listener)
      : id_(id), goal_(std::move(goal)), listener_(std::move(listener)) {}
  /// A goal whose handle goes before its end is cancelled.
  ~ServerGoalHandle() override {
    if (!is_active()) return;
    status_ = GoalStatus::STATUS_CANCELED;
    listener_.on_end(status_, std::make_shared<Result>());
  }
  void publish_feedback(std::shared_ptr<Feedback> feedback) {
    listener_.on_feedback(std::make_shared<const Feedback>(*feedback));
  }
  void succeed(std::shared_ptr<Result> result) { end(GoalStatus::STATUS_SUCCEEDED, *result); }
  void abort(std::shared_ptr<Result> result) { end(GoalStatus::STATUS_ABORTED, *result); }
  void canceled(std::shared_ptr<Result> result) { end(GoalStatus::STATUS_CANCELED, *result); }
  void execute() {
    go_to(GoalStatus::STATUS_EXECUTING);
    listener_.on_status(status_);
  }
  void rehearse_begin_cancel() {
    go_to(GoalStatus::STATUS_CANCELING);
    listener_.on_status(status_);
  }
  const std::shared_ptr<const Goal> get_goal() const { return goal_; }
  const GoalUUID& get_goal_id() const { return id_; }

 private:
  void end(std::int8_t status, const Result& result) {
    go_to(status);
    listener_.on_end(status, std::make_shared<Result>(result));
  }
  GoalUUID id_;
  std::shared_ptr<const Goal> goal_;
  GoalListener listener_;
};

class ServerBase : public RehearseMail {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(ServerBase)
  enum Order { goal, cancel };
  /// The type of its goals.
  virtual const rehearse_ros2::MessageMembers& rehearse_goal_type() const = 0;
  /// Gives it a goal of this type. Its executor calls `answer` with true if the goal is accepted.
  virtual void rehearse_send_goal(const GoalUUID& id, std::shared_ptr<const void> goal, GoalListener listener,
                                  std::function<void(bool)> answer) = 0;
};

/// The servers of the process by name, under the lock of the bus.
std::map<std::string, std::weak_ptr<ServerBase>>& rehearse_servers();

template <class Action>
class Server : public ServerBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Server)
  using Handle = ServerGoalHandle<Action>;
  using GoalCallback = std::function<GoalResponse(const GoalUUID&, std::shared_ptr<const typename Action::Goal>)>;
  using CancelCallback = std::function<CancelResponse(const std::shared_ptr<Handle>)>;
  using AcceptedCallback = std::function<void(std::shared_ptr<Handle>)>;
  Server(GoalCallback goal, CancelCallback cancel, AcceptedCallback accepted)
      : handle_goal_(std::move(goal)), handle_cancel_(std::move(cancel)), handle_accepted_(std::move(accepted)) {}

  const rehearse_ros2::MessageMembers& rehearse_goal_type() const override {
    return rehearse_ros2::members_of<typename Action::Goal>();
  }
  void rehearse_send_goal(const GoalUUID& id, std::shared_ptr<const void> goal, GoalListener listener,
                          std::function<void(bool)> answer) override {
    post(ServerBase::goal, [this, id, goal, listener, answer] {
      take_goal(id, std::static_pointer_cast<const typename Action::Goal>(goal), listener, answer);
    });
  }
  /// Cancels these goals, as the messages of ROS 2 state the result.
  std::shared_ptr<action_msgs::srv::CancelGoal::Response> rehearse_take_cancel(const std::vector<GoalUUID>& ids) {
    using Response = action_msgs::srv::CancelGoal::Response;
    const auto response = std::make_shared<Response>();
    response->return_code = ids.size() == 1 ? Response::ERROR_REJECTED : Response::ERROR_NONE;
    for (const GoalUUID& id : ids) {
      const auto found = handles_.find(id);
      const auto handle = found == handles_.end() ? nullptr : found->second.lock();
      if (!handle || !handle->is_active()) {
        if (ids.size() == 1)
          response->return_code =
              found == handles_.end() ? Response::ERROR_UNKNOWN_GOAL_ID : Response::ERROR_GOAL_TERMINATED;
        continue;
      }
      if (handle_cancel_(handle) != CancelResponse::ACCEPT) continue;
      if (handle->is_active() && !handle->is_canceling()) handle->rehearse_begin_cancel();
      GoalInfo info;
      info.goal_id.uuid = id;
      response->goals_canceling.push_back(info);
      response->return_code = Response::ERROR_NONE;
    }
    return response;
  }

 private:
  void take_goal(const GoalUUID& id, const std::shared_ptr<const typename Action::Goal>& goal,
                 const GoalListener& listener, const std::function<void(bool)>& answer) {
    const GoalResponse response = handle_goal_(id, goal);
    answer(response != GoalResponse::REJECT);
    if (response == GoalResponse::REJECT) return;
    const auto handle = std::make_shared<Handle>(id, goal, listener);
    handles_[id] = handle;
    if (response == GoalResponse::ACCEPT_AND_EXECUTE) handle->execute();
    handle_accepted_(handle);
  }
  GoalCallback handle_goal_;
  CancelCallback handle_cancel_;
  AcceptedCallback handle_accepted_;
  std::map<GoalUUID, std::weak_ptr<Handle>> handles_;
};

struct rcl_action_server_options_t {};
inline rcl_action_server_options_t rcl_action_server_get_default_options() { return {}; }

template <class Action>
typename Server<Action>::SharedPtr create_server(
    rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base, rclcpp::node_interfaces::NodeClockInterface::SharedPtr,
    rclcpp::node_interfaces::NodeLoggingInterface::SharedPtr,
    rclcpp::node_interfaces::NodeWaitablesInterface::SharedPtr waitables, const std::string& name,
    typename Server<Action>::GoalCallback handle_goal, typename Server<Action>::CancelCallback handle_cancel,
    typename Server<Action>::AcceptedCallback handle_accepted, const rcl_action_server_options_t& = {},
    rclcpp::CallbackGroup::SharedPtr group = nullptr) {
  auto server =
      std::make_shared<Server<Action>>(std::move(handle_goal), std::move(handle_cancel), std::move(handle_accepted));
  {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    rehearse_servers()[base->resolve_topic_or_service_name(name, false)] = server;
  }
  waitables->add_waitable(server, group);
  return server;
}
template <class Action, class NodeType>
typename Server<Action>::SharedPtr create_server(NodeType node, const std::string& name,
                                                 typename Server<Action>::GoalCallback handle_goal,
                                                 typename Server<Action>::CancelCallback handle_cancel,
                                                 typename Server<Action>::AcceptedCallback handle_accepted,
                                                 const rcl_action_server_options_t& options = {},
                                                 rclcpp::CallbackGroup::SharedPtr group = nullptr) {
  return create_server<Action>(node->get_node_base_interface(), node->get_node_clock_interface(),
                               node->get_node_logging_interface(), node->get_node_waitables_interface(), name,
                               std::move(handle_goal), std::move(handle_cancel), std::move(handle_accepted), options,
                               group);
}

}  // namespace rclcpp_action
