// Nodes with states.
#include <lifecycle_msgs/srv/change_state.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>

#include "client_library.h"

namespace {

using Return = rclcpp_lifecycle::LifecycleNode::CallbackReturn;
using lifecycle_msgs::msg::State;
using lifecycle_msgs::msg::Transition;

TEST_F(ClientLibrary, ALifecycleNodeGoesThroughItsStates) {
  rclcpp_lifecycle::LifecycleNode managed("managed");
  EXPECT_EQ(managed.get_current_state().id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(managed.activate().id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(managed.configure().id(), State::PRIMARY_STATE_INACTIVE);
  EXPECT_EQ(managed.activate().id(), State::PRIMARY_STATE_ACTIVE);
  EXPECT_EQ(managed.deactivate().id(), State::PRIMARY_STATE_INACTIVE);
  EXPECT_EQ(managed.cleanup().id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(managed.shutdown().id(), State::PRIMARY_STATE_FINALIZED);
}

TEST_F(ClientLibrary, FailuresAndErrorsOfTransitionsLeadToTheirStates) {
  rclcpp_lifecycle::LifecycleNode managed("managed");
  Return result{};
  managed.register_on_configure([](const auto&) { return Return::FAILURE; });
  EXPECT_EQ(managed.configure(result).id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(result, Return::FAILURE);
  managed.register_on_configure([](const auto&) -> Return { throw std::runtime_error("broken"); });
  managed.register_on_error([](const auto&) { return Return::SUCCESS; });
  EXPECT_EQ(managed.configure(result).id(), State::PRIMARY_STATE_UNCONFIGURED);
  EXPECT_EQ(result, Return::ERROR);
  managed.register_on_error([](const auto&) { return Return::FAILURE; });
  EXPECT_EQ(managed.configure().id(), State::PRIMARY_STATE_FINALIZED);
}

TEST_F(ClientLibrary, APublisherOfANodeThatIsNotActivePublishesNothing) {
  rclcpp_lifecycle::LifecycleNode managed("managed");
  const auto publisher = managed.create_publisher<Int32>("t", 1);
  int count = 0;
  const auto subscription = node->create_subscription<Int32>("t", 5, [&](const Int32&) { ++count; });
  managed.configure();
  publisher->publish(number(1));
  executor->spin_all(0s);
  EXPECT_EQ(count, 0);
  managed.activate();
  publisher->publish(number(1));
  executor->spin_all(0s);
  EXPECT_EQ(count, 1);
}

TEST_F(ClientLibrary, StatesAreChangedByAService) {
  const auto managed = std::make_shared<rclcpp_lifecycle::LifecycleNode>("managed");
  executor->add_node(managed->get_node_base_interface());
  EXPECT_EQ(node->get_service_names_and_types().at("/managed/change_state"),
            std::vector<std::string>{"lifecycle_msgs/srv/ChangeState"});
  const auto client = node->create_client<lifecycle_msgs::srv::ChangeState>("managed/change_state");
  auto request = std::make_shared<lifecycle_msgs::srv::ChangeState::Request>();
  request->transition.id = Transition::TRANSITION_CONFIGURE;
  auto configured = client->async_send_request(request);
  ASSERT_EQ(executor->spin_until_future_complete(configured), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_TRUE(configured.get()->success);
  EXPECT_EQ(managed->get_current_state().id(), State::PRIMARY_STATE_INACTIVE);
  request->transition.label = "activate";  // a label counts more than a number
  auto activated = client->async_send_request(request);
  ASSERT_EQ(executor->spin_until_future_complete(activated), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_TRUE(activated.get()->success);
  EXPECT_EQ(managed->get_current_state().id(), State::PRIMARY_STATE_ACTIVE);
}

}  // namespace
