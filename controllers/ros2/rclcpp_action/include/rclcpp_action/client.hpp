// The client of an action. It takes feedback first, then states, answers to goals, results, answers to cancellations.
#pragma once

#include <future>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "rclcpp_action/server.hpp"

namespace rclcpp_action {

template <class Action>
class Client;

template <class Action>
class ClientGoalHandle {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(ClientGoalHandle)
  using Goal = typename Action::Goal;
  using Result = typename Action::Result;
  using Feedback = typename Action::Feedback;
  struct WrappedResult {
    GoalUUID goal_id{};
    ResultCode code = ResultCode::UNKNOWN;
    std::shared_ptr<Result> result;
  };
  using FeedbackCallback =
      std::function<void(std::shared_ptr<ClientGoalHandle>, const std::shared_ptr<const Feedback>)>;
  using ResultCallback = std::function<void(const WrappedResult&)>;
  ClientGoalHandle(const GoalUUID& id, const rclcpp::Time& stamp) : id_(id), stamp_(stamp) {}
  const GoalUUID& get_goal_id() const { return id_; }
  rclcpp::Time get_goal_stamp() const { return stamp_; }
  std::int8_t get_status() const { return status_; }
  bool is_feedback_aware() const { return static_cast<bool>(on_feedback_); }
  bool is_result_aware() const { return is_result_aware_; }

 private:
  friend class Client<Action>;
  GoalUUID id_;
  rclcpp::Time stamp_;
  std::int8_t status_ = GoalStatus::STATUS_ACCEPTED;
  bool is_result_aware_ = false;
  FeedbackCallback on_feedback_;
  std::vector<ResultCallback> on_result_;
  std::promise<WrappedResult> promise_;
  std::shared_future<WrappedResult> future_{promise_.get_future().share()};
};

template <class Action>
class Client : public RehearseMail, public std::enable_shared_from_this<Client<Action>> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Client)
  using Goal = typename Action::Goal;
  using Feedback = typename Action::Feedback;
  using Result = typename Action::Result;
  using GoalHandle = ClientGoalHandle<Action>;
  using WrappedResult = typename GoalHandle::WrappedResult;
  using GoalResponseCallback = std::function<void(typename GoalHandle::SharedPtr)>;
  using FeedbackCallback = typename GoalHandle::FeedbackCallback;
  using ResultCallback = typename GoalHandle::ResultCallback;
  using CancelRequest = action_msgs::srv::CancelGoal::Request;
  using CancelResponse = action_msgs::srv::CancelGoal::Response;
  using CancelCallback = std::function<void(std::shared_ptr<CancelResponse>)>;
  struct SendGoalOptions {
    GoalResponseCallback goal_response_callback;
    FeedbackCallback feedback_callback;
    ResultCallback result_callback;
  };
  enum Order { feedback, status, goal, result, cancel };

  explicit Client(std::string name) : name_(std::move(name)) {}
  bool action_server_is_ready() const { return find() != nullptr; }
  template <class Count = std::int64_t, class Period = std::milli>
  bool wait_for_action_server(
      std::chrono::duration<Count, Period> timeout = std::chrono::duration<Count, Period>(-1)) const {
    return rehearse_ros2::Bus::instance().wait_for(std::chrono::duration_cast<std::chrono::nanoseconds>(timeout),
                                                   [this] { return action_server_is_ready(); });
  }

  std::shared_future<typename GoalHandle::SharedPtr> async_send_goal(
      const Goal& goal_message, const SendGoalOptions& options = SendGoalOptions()) {
    const auto promise = open_promise<typename GoalHandle::SharedPtr>();
    const auto future = promise->get_future().share();
    const auto server = find();
    if (!server) return future;  // nobody answers, as in life
    const GoalUUID id = rehearse_next_id();
    const auto handle =
        std::make_shared<GoalHandle>(id, rclcpp::Time(rehearse_ros2::read_clock(RCL_ROS_TIME), RCL_ROS_TIME));
    handle->on_feedback_ = options.feedback_callback;
    if (options.result_callback) {
      handle->is_result_aware_ = true;
      handle->on_result_.push_back(options.result_callback);
    }
    const std::weak_ptr<Client> self = this->weak_from_this();
    GoalListener listener;
    listener.on_feedback = [self, handle](std::shared_ptr<const void> message) {
      tell(self, feedback, [handle, message](Client&) {
        if (handle->on_feedback_) handle->on_feedback_(handle, std::static_pointer_cast<const Feedback>(message));
      });
    };
    listener.on_status = [self, handle](std::int8_t now) {
      tell(self, status, [handle, now](Client&) { handle->status_ = now; });
    };
    listener.on_end = [self, handle](std::int8_t end, std::shared_ptr<void> message) {
      tell(self, result, [handle, end, message](Client& client) { client.finish(handle, end, message); });
    };
    const auto answer = [self, handle, promise, options](bool is_accepted) {
      tell(self, goal, [handle, promise, options, is_accepted](Client& client) {
        if (is_accepted) client.handles_[handle->id_] = handle;
        promise->set_value(is_accepted ? handle : nullptr);
        client.close(promise);
        if (options.goal_response_callback) options.goal_response_callback(is_accepted ? handle : nullptr);
      });
    };
    server->rehearse_send_goal(id, std::make_shared<const Goal>(goal_message), listener, answer);
    return future;
  }
  std::shared_future<WrappedResult> async_get_result(typename GoalHandle::SharedPtr handle,
                                                     ResultCallback callback = nullptr) {
    const bool is_known = handles_.count(handle->id_) > 0;
    const bool is_over = handle->future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_known && !is_over) throw exceptions::UnknownGoalHandleError();
    handle->is_result_aware_ = true;
    if (!callback) return handle->future_;
    if (is_over)
      post(result, [handle, callback] { callback(handle->future_.get()); });
    else
      handle->on_result_.push_back(std::move(callback));
    return handle->future_;
  }
  std::shared_future<typename CancelResponse::SharedPtr> async_cancel_goal(typename GoalHandle::SharedPtr handle,
                                                                           CancelCallback callback = nullptr) {
    if (handles_.count(handle->id_) == 0) throw exceptions::UnknownGoalHandleError();
    return send_cancel({handle->id_}, std::move(callback));
  }
  std::shared_future<typename CancelResponse::SharedPtr> async_cancel_all_goals(CancelCallback callback = nullptr) {
    std::vector<GoalUUID> ids;
    for (const auto& known : handles_) ids.push_back(known.first);
    return send_cancel(ids, std::move(callback));
  }
  std::shared_future<typename CancelResponse::SharedPtr> async_cancel_goals_before(const rclcpp::Time& stamp,
                                                                                   CancelCallback callback = nullptr) {
    std::vector<GoalUUID> ids;
    for (const auto& [id, handle] : handles_)
      if (handle->stamp_.nanoseconds() <= stamp.nanoseconds()) ids.push_back(id);
    return send_cancel(ids, std::move(callback));
  }
  void stop_callbacks(typename GoalHandle::SharedPtr handle) {
    handle->on_feedback_ = nullptr;
    handle->on_result_.clear();
  }

 private:
  std::shared_ptr<Server<Action>> find() const {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    const auto found = rehearse_servers().find(name_);
    if (found == rehearse_servers().end()) return nullptr;
    return std::dynamic_pointer_cast<Server<Action>>(found->second.lock());
  }
  template <class Value>
  std::shared_ptr<std::promise<Value>> open_promise() {
    auto promise = std::make_shared<std::promise<Value>>();
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    open_.insert(promise);
    return promise;
  }
  void close(const std::shared_ptr<void>& promise) {
    const rehearse_ros2::BusLock lock(rehearse_ros2::Bus::instance().mutex);
    open_.erase(promise);
  }
  template <class Work>
  static void tell(const std::weak_ptr<Client>& self, Order order, Work work) {
    const auto client = self.lock();
    if (!client) return;
    client->post(order, [self, work] {
      if (const auto there = self.lock()) work(*there);
    });
  }
  void finish(const std::shared_ptr<GoalHandle>& handle, std::int8_t end, const std::shared_ptr<void>& message) {
    handle->status_ = end;
    WrappedResult wrapped{handle->id_, static_cast<ResultCode>(end), std::static_pointer_cast<Result>(message)};
    handle->promise_.set_value(wrapped);
    handles_.erase(handle->id_);
    const auto callbacks = handle->on_result_;
    for (const ResultCallback& callback : callbacks) callback(wrapped);
  }
  std::shared_future<typename CancelResponse::SharedPtr> send_cancel(const std::vector<GoalUUID>& ids,
                                                                     CancelCallback callback) {
    const auto promise = open_promise<typename CancelResponse::SharedPtr>();
    const auto future = promise->get_future().share();
    const auto server = find();
    if (!server) return future;
    const std::weak_ptr<Client> self = this->weak_from_this();
    const std::weak_ptr<Server<Action>> to = server;
    server->post(ServerBase::cancel, [self, to, ids, promise, callback] {
      const auto there = to.lock();
      if (!there) return;
      const auto response = there->rehearse_take_cancel(ids);
      tell(self, cancel, [promise, callback, response](Client& client) {
        promise->set_value(response);
        client.close(promise);
        if (callback) callback(response);
      });
    });
    return future;
  }

  std::string name_;
  std::map<GoalUUID, typename GoalHandle::SharedPtr> handles_;
  std::set<std::shared_ptr<void>>
      open_;  // promises of answers to come, under the lock of the bus: futures of others throw
};

struct rcl_action_client_options_t {};
inline rcl_action_client_options_t rcl_action_client_get_default_options() { return {}; }

template <class Action>
typename Client<Action>::SharedPtr create_client(rclcpp::node_interfaces::NodeBaseInterface::SharedPtr base,
                                                 rclcpp::node_interfaces::NodeGraphInterface::SharedPtr,
                                                 rclcpp::node_interfaces::NodeLoggingInterface::SharedPtr,
                                                 rclcpp::node_interfaces::NodeWaitablesInterface::SharedPtr waitables,
                                                 const std::string& name,
                                                 rclcpp::CallbackGroup::SharedPtr group = nullptr,
                                                 const rcl_action_client_options_t& = {}) {
  auto client = std::make_shared<Client<Action>>(base->resolve_topic_or_service_name(name, false));
  waitables->add_waitable(client, group);
  return client;
}
template <class Action, class NodeType>
typename Client<Action>::SharedPtr create_client(NodeType node, const std::string& name,
                                                 rclcpp::CallbackGroup::SharedPtr group = nullptr,
                                                 const rcl_action_client_options_t& options = {}) {
  return create_client<Action>(node->get_node_base_interface(), node->get_node_graph_interface(),
                               node->get_node_logging_interface(), node->get_node_waitables_interface(), name, group,
                               options);
}

}  // namespace rclcpp_action
