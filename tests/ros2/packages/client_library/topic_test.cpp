// Topics, and the qualities of their publishers and subscriptions.
#include <functional>
#include <std_msgs/msg/string.hpp>

#include "client_library.h"

namespace {

TEST_F(ClientLibrary, EachFormOfACallbackGetsTheMessage) {
  Numbers seen;
  const auto keep = [&](int form) { seen.push_back(form); };
  const rclcpp::QoS qos(1);
  std::vector<rclcpp::SubscriptionBase::SharedPtr> all{
      node->create_subscription<Int32>("t", qos, [&](const Int32& m) { keep(m.data); }),
      node->create_subscription<Int32>("t", qos, [&](Int32::SharedPtr m) { keep(m->data + 1); }),
      node->create_subscription<Int32>("t", qos, [&](Int32::ConstSharedPtr m) { keep(m->data + 2); }),
      node->create_subscription<Int32>("t", qos, [&](Int32::UniquePtr m) { keep(m->data + 3); }),
      node->create_subscription<Int32>("t", qos, [&](const Int32& m, const rclcpp::MessageInfo&) { keep(m.data + 4); }),
      node->create_subscription<Int32>(
          "t", qos, std::bind([&](Int32::ConstSharedPtr m) { keep(m->data + 5); }, std::placeholders::_1))};
  node->create_publisher<Int32>("t", qos)->publish(number(10));
  executor->spin_some();
  EXPECT_EQ(seen, (Numbers{10, 11, 12, 13, 14, 15}));
}

TEST_F(ClientLibrary, AReceiverThatChangesItsMessageChangesNoOther) {
  Numbers seen;
  const auto one = node->create_subscription<Int32>("t", 1, [&](Int32::SharedPtr m) { seen.push_back(m->data++); });
  const auto two = node->create_subscription<Int32>("t", 1, [&](Int32::SharedPtr m) { seen.push_back(m->data++); });
  node->create_publisher<Int32>("t", 1)->publish(number(1));
  executor->spin_some();
  EXPECT_EQ(seen, (Numbers{1, 1}));
}

TEST_F(ClientLibrary, AQueueKeepsTheLastMessagesOfItsDepth) {
  Numbers seen;
  const auto subscription = node->create_subscription<Int32>("t", 3, [&](const Int32& m) { seen.push_back(m.data); });
  const auto publisher = node->create_publisher<Int32>("t", 1);
  for (int i = 0; i < 10; ++i) publisher->publish(number(i));
  executor->spin_all(0s);
  EXPECT_EQ(seen, (Numbers{7, 8, 9}));
}

TEST_F(ClientLibrary, AQueueThatKeepsAllLosesNone) {
  int count = 0;
  const auto subscription =
      node->create_subscription<Int32>("t", rclcpp::QoS(rclcpp::KeepAll()), [&](const Int32&) { ++count; });
  const auto publisher = node->create_publisher<Int32>("t", 1);
  for (int i = 0; i < 1000; ++i) publisher->publish(number(i));
  executor->spin_all(0s);
  EXPECT_EQ(count, 1000);
}

TEST_F(ClientLibrary, ALateSubscriptionGetsWhatIsLatched) {
  const auto latched = rclcpp::QoS(2).transient_local();
  const auto publisher = node->create_publisher<Int32>("t", latched);
  for (int i = 0; i < 5; ++i) publisher->publish(number(i));
  Numbers seen, seen_by_volatile;
  const auto late = node->create_subscription<Int32>("t", latched, [&](const Int32& m) { seen.push_back(m.data); });
  const auto other =
      node->create_subscription<Int32>("t", 5, [&](const Int32& m) { seen_by_volatile.push_back(m.data); });
  executor->spin_all(0s);
  EXPECT_EQ(seen, (Numbers{3, 4}));
  EXPECT_EQ(seen_by_volatile, Numbers());
}

TEST_F(ClientLibrary, ALateSubscriptionOfAVolatileTopicGetsNothing) {
  const auto publisher = node->create_publisher<Int32>("t", 5);
  publisher->publish(number(1));
  int count = 0;
  const auto late = node->create_subscription<Int32>("t", 5, [&](const Int32&) { ++count; });
  executor->spin_all(0s);
  EXPECT_EQ(count, 0);
}

TEST_F(ClientLibrary, QualitiesThatDoNotFitConnectNothing) {
  int count = 0;
  const auto reliable =
      node->create_subscription<Int32>("t", rclcpp::QoS(5).reliable(), [&](const Int32&) { ++count; });
  const auto latched =
      node->create_subscription<Int32>("t", rclcpp::QoS(5).transient_local(), [&](const Int32&) { count += 100; });
  node->create_publisher<Int32>("t", rclcpp::QoS(5).best_effort())->publish(number(1));
  executor->spin_all(0s);
  EXPECT_EQ(count, 0);
  EXPECT_EQ(rclcpp::qos_check_compatible(rclcpp::QoS(5).best_effort(), rclcpp::QoS(5)).compatibility,
            rclcpp::QoSCompatibility::Error);
}

TEST_F(ClientLibrary, ATopicOfAnotherTypeIsRefused) {
  const auto publisher = node->create_publisher<Int32>("t", 1);
  EXPECT_THROW((void)node->create_publisher<std_msgs::msg::String>("t", 1), rclcpp::exceptions::InvalidTopicNameError);
}

TEST_F(ClientLibrary, PublishersAndSubscriptionsAreCounted) {
  auto publisher = node->create_publisher<Int32>("t", 1);
  const auto subscription = node->create_subscription<Int32>("/t", 1, [](const Int32&) {});
  EXPECT_EQ(publisher->get_subscription_count(), 1u);
  EXPECT_EQ(subscription->get_publisher_count(), 1u);
  EXPECT_EQ(node->count_subscribers("t"), 1u);
  publisher.reset();
  EXPECT_EQ(node->count_publishers("/t"), 0u);
  EXPECT_EQ(node->get_topic_names_and_types().at("/t"), std::vector<std::string>{"std_msgs/msg/Int32"});
}

}  // namespace
