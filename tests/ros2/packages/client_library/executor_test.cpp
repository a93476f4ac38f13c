// Executors and wait sets.
#include <future>
#include <std_srvs/srv/trigger.hpp>
#include <thread>

#include "client_library.h"

namespace {

TEST_F(ClientLibrary, TimersComeBeforeSubscriptionsAndServices) {
  std::string order;
  const auto service = node->create_service<std_srvs::srv::Trigger>(
      "s",
      [&](std_srvs::srv::Trigger::Request::SharedPtr, std_srvs::srv::Trigger::Response::SharedPtr) { order += 'v'; });
  const auto subscription = node->create_subscription<Int32>("t", 1, [&](const Int32&) { order += 's'; });
  const auto timer = node->create_timer(1s, [&] { order += 't'; });
  const auto client = node->create_client<std_srvs::srv::Trigger>("s");
  client->async_send_request(std::make_shared<std_srvs::srv::Trigger::Request>(),
                             [&](rclcpp::Client<std_srvs::srv::Trigger>::SharedFuture) { order += 'c'; });
  node->create_publisher<Int32>("t", 1)->publish(number(1));
  go_to(1.5);
  executor->spin_all(0s);
  EXPECT_EQ(order, "tsvc");
}

TEST_F(ClientLibrary, SpinSomeTakesOneMessageOfEachSubscription) {
  Numbers seen;
  const auto one = node->create_subscription<Int32>("t", 5, [&](const Int32& m) { seen.push_back(m.data); });
  const auto two = node->create_subscription<Int32>("t", 5, [&](const Int32& m) { seen.push_back(10 + m.data); });
  const auto publisher = node->create_publisher<Int32>("t", 5);
  publisher->publish(number(1));
  publisher->publish(number(2));
  executor->spin_some();
  EXPECT_EQ(seen, (Numbers{1, 11}));
  executor->spin_some();
  EXPECT_EQ(seen, (Numbers{1, 11, 2, 12}));
}

TEST_F(ClientLibrary, WhatACallbackPublishesWaitsForTheNextSpinSome) {
  Numbers seen;
  const auto out = node->create_publisher<Int32>("u", 5);
  const auto first = node->create_subscription<Int32>("t", 5, [&](const Int32& m) { out->publish(m); });
  const auto second_ = node->create_subscription<Int32>("u", 5, [&](const Int32& m) { seen.push_back(m.data); });
  node->create_publisher<Int32>("t", 5)->publish(number(1));
  executor->spin_some();
  EXPECT_EQ(seen, Numbers());
  executor->spin_some();
  EXPECT_EQ(seen, Numbers{1});
}

TEST_F(ClientLibrary, SpinOnceDoesOneThing) {
  int calls = 0;
  const auto subscription = node->create_subscription<Int32>("t", 5, [&](const Int32&) { ++calls; });
  const auto publisher = node->create_publisher<Int32>("t", 5);
  publisher->publish(number(1));
  publisher->publish(number(2));
  executor->spin_once(0s);
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, ANodeBelongsToOneExecutor) {
  rclcpp::executors::SingleThreadedExecutor other;
  EXPECT_THROW(other.add_node(node), std::runtime_error);
  executor->remove_node(node);
  other.add_node(node);
}

TEST_F(ClientLibrary, ASpinningExecutorIsNotSpunAgain) {
  std::string problem;
  const auto subscription = node->create_subscription<Int32>("t", 5, [&](const Int32&) {
    try {
      executor->spin_some();
    } catch (const std::runtime_error& refused) {
      problem = refused.what();
    }
  });
  node->create_publisher<Int32>("t", 5)->publish(number(1));
  executor->spin_some();
  EXPECT_EQ(problem, "spin_some() called while already spinning");
}

TEST_F(ClientLibrary, AGroupOfItsOwnIsSpunByItsOwnExecutor) {
  const auto group = node->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive, false);
  rclcpp::SubscriptionOptions options;
  options.callback_group = group;
  int calls = 0;
  const auto subscription = node->create_subscription<Int32>(
      "t", 5, [&](const Int32&) { ++calls; }, options);
  node->create_publisher<Int32>("t", 5)->publish(number(1));
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  rclcpp::executors::SingleThreadedExecutor other;
  other.add_callback_group(group, node->get_node_base_interface());
  other.spin_some();
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, SpinEndsWhenItIsCancelledByAnotherThread) {
  std::promise<void> is_called;
  const auto subscription = node->create_subscription<Int32>("t", 5, [&](const Int32&) { is_called.set_value(); });
  std::thread spinning([&] { executor->spin(); });
  node->create_publisher<Int32>("t", 5)->publish(number(1));
  is_called.get_future().wait();
  executor->cancel();
  spinning.join();
  EXPECT_FALSE(executor->is_spinning());
}

TEST_F(ClientLibrary, AWaitSetSeesMessagesAndTimeouts) {
  const auto subscription = node->create_subscription<Int32>("t", 5, [](const Int32&) {});
  rclcpp::WaitSet set({subscription});
  EXPECT_EQ(set.wait(1ms).kind(), rclcpp::WaitResultKind::Timeout);
  node->create_publisher<Int32>("t", 5)->publish(number(4));
  ASSERT_EQ(set.wait(10s).kind(), rclcpp::WaitResultKind::Ready);
  Int32 message;
  rclcpp::MessageInfo info;
  ASSERT_TRUE(subscription->take(message, info));
  EXPECT_EQ(message.data, 4);
  rclcpp::WaitSet other;
  EXPECT_THROW(other.add_subscription(subscription), std::runtime_error);
}

}  // namespace
