#include "rclcpp_lifecycle/lifecycle_node.hpp"

#include <lifecycle_msgs/srv/change_state.hpp>
#include <lifecycle_msgs/srv/get_available_states.hpp>
#include <lifecycle_msgs/srv/get_available_transitions.hpp>
#include <lifecycle_msgs/srv/get_state.hpp>

#include <algorithm>

namespace rclcpp_lifecycle {
namespace {

using StateMessage = lifecycle_msgs::msg::State;
using TransitionMessage = lifecycle_msgs::msg::Transition;

struct StateRow {
  std::uint8_t id;
  const char* label;
};
constexpr StateRow state_rows[] = {
    {StateMessage::PRIMARY_STATE_UNKNOWN, "unknown"},
    {StateMessage::PRIMARY_STATE_UNCONFIGURED, "unconfigured"},
    {StateMessage::PRIMARY_STATE_INACTIVE, "inactive"},
    {StateMessage::PRIMARY_STATE_ACTIVE, "active"},
    {StateMessage::PRIMARY_STATE_FINALIZED, "finalized"},
    {StateMessage::TRANSITION_STATE_CONFIGURING, "configuring"},
    {StateMessage::TRANSITION_STATE_CLEANINGUP, "cleaningup"},
    {StateMessage::TRANSITION_STATE_SHUTTINGDOWN, "shuttingdown"},
    {StateMessage::TRANSITION_STATE_ACTIVATING, "activating"},
    {StateMessage::TRANSITION_STATE_DEACTIVATING, "deactivating"},
    {StateMessage::TRANSITION_STATE_ERRORPROCESSING, "errorprocessing"},
};

State state_of(std::uint8_t id) {
  for (const StateRow& row : state_rows)
    if (row.id == id) return State(id, row.label);
  return State(id, "unknown");
}

/// From a state by a state in which the callback runs to the states after success and after failure.
struct TransitionRow {
  std::uint8_t id;
  const char* label;
  std::uint8_t from, during, after_success, after_failure;
};
constexpr TransitionRow transition_rows[] = {
    {TransitionMessage::TRANSITION_CONFIGURE, "configure", StateMessage::PRIMARY_STATE_UNCONFIGURED,
     StateMessage::TRANSITION_STATE_CONFIGURING, StateMessage::PRIMARY_STATE_INACTIVE,
     StateMessage::PRIMARY_STATE_UNCONFIGURED},
    {TransitionMessage::TRANSITION_CLEANUP, "cleanup", StateMessage::PRIMARY_STATE_INACTIVE,
     StateMessage::TRANSITION_STATE_CLEANINGUP, StateMessage::PRIMARY_STATE_UNCONFIGURED,
     StateMessage::PRIMARY_STATE_INACTIVE},
    {TransitionMessage::TRANSITION_ACTIVATE, "activate", StateMessage::PRIMARY_STATE_INACTIVE,
     StateMessage::TRANSITION_STATE_ACTIVATING, StateMessage::PRIMARY_STATE_ACTIVE,
     StateMessage::PRIMARY_STATE_INACTIVE},
    {TransitionMessage::TRANSITION_DEACTIVATE, "deactivate", StateMessage::PRIMARY_STATE_ACTIVE,
     StateMessage::TRANSITION_STATE_DEACTIVATING, StateMessage::PRIMARY_STATE_INACTIVE,
     StateMessage::PRIMARY_STATE_ACTIVE},
    {TransitionMessage::TRANSITION_UNCONFIGURED_SHUTDOWN, "shutdown", StateMessage::PRIMARY_STATE_UNCONFIGURED,
     StateMessage::TRANSITION_STATE_SHUTTINGDOWN, StateMessage::PRIMARY_STATE_FINALIZED,
     StateMessage::PRIMARY_STATE_FINALIZED},
    {TransitionMessage::TRANSITION_INACTIVE_SHUTDOWN, "shutdown", StateMessage::PRIMARY_STATE_INACTIVE,
     StateMessage::TRANSITION_STATE_SHUTTINGDOWN, StateMessage::PRIMARY_STATE_FINALIZED,
     StateMessage::PRIMARY_STATE_FINALIZED},
    {TransitionMessage::TRANSITION_ACTIVE_SHUTDOWN, "shutdown", StateMessage::PRIMARY_STATE_ACTIVE,
     StateMessage::TRANSITION_STATE_SHUTTINGDOWN, StateMessage::PRIMARY_STATE_FINALIZED,
     StateMessage::PRIMARY_STATE_FINALIZED},
};

Transition transition_of(const TransitionRow& row) {
  return {row.id, row.label, state_of(row.from), state_of(row.during)};
}

StateMessage message_of(const State& state) {
  StateMessage message;
  message.id = state.id();
  message.label = state.label();
  return message;
}
lifecycle_msgs::msg::TransitionDescription description_of(const Transition& transition) {
  lifecycle_msgs::msg::TransitionDescription description;
  description.transition.id = transition.id();
  description.transition.label = transition.label();
  description.start_state = message_of(transition.start_state());
  description.goal_state = message_of(transition.goal_state());
  return description;
}

}  // namespace

LifecycleNode::LifecycleNode(const std::string& name, const std::string& space, const rclcpp::NodeOptions& options,
                             bool enable_communication_interface)
    : RehearseNode(name, space, options),
      state_(state_of(StateMessage::PRIMARY_STATE_UNCONFIGURED)),
      configure_([this](const State& previous) { return on_configure(previous); }),
      cleanup_([this](const State& previous) { return on_cleanup(previous); }),
      activate_([this](const State& previous) { return on_activate(previous); }),
      deactivate_([this](const State& previous) { return on_deactivate(previous); }),
      shutdown_([this](const State& previous) { return on_shutdown(previous); }),
      error_([this](const State& previous) { return on_error(previous); }) {
  if (!enable_communication_interface) return;
  namespace srv = lifecycle_msgs::srv;
  events_ = rclcpp::create_publisher<lifecycle_msgs::msg::TransitionEvent>(get_node_topics_interface(),
                                                                           "~/transition_event", rclcpp::QoS(10));
  services_.push_back(create_service<srv::ChangeState>(
      "~/change_state",
      [this](srv::ChangeState::Request::SharedPtr request, srv::ChangeState::Response::SharedPtr response) {
        std::uint8_t id = request->transition.id;
        for (const Transition& transition : get_available_transitions())
          if (!request->transition.label.empty() && transition.label() == request->transition.label)
            id = transition.id();
        CallbackReturn result = CallbackReturn::ERROR;
        trigger_transition(id, result);
        response->success = result == CallbackReturn::SUCCESS;
      }));
  services_.push_back(create_service<srv::GetState>(
      "~/get_state", [this](srv::GetState::Request::SharedPtr, srv::GetState::Response::SharedPtr response) {
        response->current_state = message_of(state_);
      }));
  services_.push_back(create_service<srv::GetAvailableStates>(
      "~/get_available_states",
      [this](srv::GetAvailableStates::Request::SharedPtr, srv::GetAvailableStates::Response::SharedPtr response) {
        for (const State& state : get_available_states()) response->available_states.push_back(message_of(state));
      }));
  const auto transitions = [this](bool all) {
    return [this, all](srv::GetAvailableTransitions::Request::SharedPtr,
                       srv::GetAvailableTransitions::Response::SharedPtr response) {
      for (const Transition& transition : all ? get_transition_graph() : get_available_transitions())
        response->available_transitions.push_back(description_of(transition));
    };
  };
  services_.push_back(create_service<srv::GetAvailableTransitions>("~/get_available_transitions", transitions(false)));
  services_.push_back(create_service<srv::GetAvailableTransitions>("~/get_transition_graph", transitions(true)));
}

LifecycleNode::~LifecycleNode() = default;

LifecycleNode::CallbackReturn LifecycleNode::call(const LifecycleCallback& callback, const State& previous) {
  try {
    return callback(previous);
  } catch (const std::exception& problem) {
    RCLCPP_ERROR(get_logger(), "The callback of the state '%s' threw: %s", state_.label().c_str(), problem.what());
    return CallbackReturn::ERROR;
  }
}

void LifecycleNode::go_to(std::uint8_t id, const Transition& transition) {
  const State before = state_;
  state_ = state_of(id);
  if (!events_) return;
  lifecycle_msgs::msg::TransitionEvent event;
  event.timestamp = static_cast<std::uint64_t>(now().nanoseconds());
  event.transition.id = transition.id();
  event.transition.label = transition.label();
  event.start_state = message_of(before);
  event.goal_state = message_of(state_);
  events_->publish(event);
}

const State& LifecycleNode::trigger_transition(std::uint8_t id, CallbackReturn& result) {
  const auto* const row = std::find_if(std::begin(transition_rows), std::end(transition_rows),
                                       [&](const auto& known) { return known.id == id && known.from == state_.id(); });
  result = CallbackReturn::ERROR;
  if (row == std::end(transition_rows)) {
    RCLCPP_ERROR(get_logger(), "The state '%s' has no transition %u", state_.label().c_str(), id);
    return state_;
  }
  const State before = state_;
  const Transition transition = transition_of(*row);
  go_to(row->during, transition);
  const LifecycleCallback* callback = &shutdown_;
  switch (row->during) {
    case StateMessage::TRANSITION_STATE_CONFIGURING: callback = &configure_; break;
    case StateMessage::TRANSITION_STATE_CLEANINGUP: callback = &cleanup_; break;
    case StateMessage::TRANSITION_STATE_ACTIVATING: callback = &activate_; break;
    case StateMessage::TRANSITION_STATE_DEACTIVATING: callback = &deactivate_; break;
    default: break;
  }
  result = call(*callback, before);
  if (result == CallbackReturn::ERROR) {
    const State during = state_;
    go_to(StateMessage::TRANSITION_STATE_ERRORPROCESSING, transition);
    const bool is_handled = call(error_, during) == CallbackReturn::SUCCESS;
    go_to(is_handled ? StateMessage::PRIMARY_STATE_UNCONFIGURED : StateMessage::PRIMARY_STATE_FINALIZED, transition);
  } else {
    go_to(result == CallbackReturn::SUCCESS ? row->after_success : row->after_failure, transition);
  }
  return state_;
}

#define REHEARSE_TRANSITION(name, label)                                      \
  const State& LifecycleNode::name() {                                        \
    CallbackReturn ignored;                                                   \
    return name(ignored);                                                     \
  }                                                                           \
  const State& LifecycleNode::name(CallbackReturn& result) {                  \
    return trigger_transition(TransitionMessage::TRANSITION_##label, result); \
  }
REHEARSE_TRANSITION(configure, CONFIGURE)
REHEARSE_TRANSITION(cleanup, CLEANUP)
REHEARSE_TRANSITION(activate, ACTIVATE)
REHEARSE_TRANSITION(deactivate, DEACTIVATE)
#undef REHEARSE_TRANSITION

const State& LifecycleNode::shutdown() {
  CallbackReturn ignored;
  return shutdown(ignored);
}
const State& LifecycleNode::shutdown(CallbackReturn& result) {
  for (const Transition& transition : get_available_transitions())
    if (transition.label() == "shutdown") return trigger_transition(transition.id(), result);
  result = CallbackReturn::ERROR;
  return state_;
}

std::vector<State> LifecycleNode::get_available_states() const {
  std::vector<State> states;
  for (const StateRow& row : state_rows) states.emplace_back(row.id, row.label);
  return states;
}
std::vector<Transition> LifecycleNode::get_available_transitions() const {
  std::vector<Transition> transitions;
  for (const TransitionRow& row : transition_rows)
    if (row.from == state_.id()) transitions.push_back(transition_of(row));
  return transitions;
}
std::vector<Transition> LifecycleNode::get_transition_graph() const {
  std::vector<Transition> transitions;
  for (const TransitionRow& row : transition_rows) transitions.push_back(transition_of(row));
  return transitions;
}

LifecycleNode::CallbackReturn LifecycleNode::on_activate(const State&) {
  for (const auto& known : entities_)
    if (const auto entity = known.lock()) entity->on_activate();
  return CallbackReturn::SUCCESS;
}
LifecycleNode::CallbackReturn LifecycleNode::on_deactivate(const State&) {
  for (const auto& known : entities_)
    if (const auto entity = known.lock()) entity->on_deactivate();
  return CallbackReturn::SUCCESS;
}

}  // namespace rclcpp_lifecycle
