// The documented behaviour of rclcpp, rclcpp_action and rclcpp_lifecycle. Time is real here; timers run by ROS time,
// which set_ros_time() moves.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/joint_state.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/float64_multi_array.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <tf2_msgs/action/lookup_transform.hpp>

using namespace std::chrono_literals;
using std_msgs::msg::Int32;

namespace {

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t date = 1'700'000'000 * second;

class ClientLibrary : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const arguments[] = {"test", "--ros-args", "--log-level", "fatal"};
    rclcpp::init(4, arguments);
    rehearse_ros2::set_ros_time(date);
    node = std::make_shared<rclcpp::Node>("node");
    executor.emplace();
    executor->add_node(node);
  }
  void TearDown() override {
    executor.reset();
    node.reset();
    rclcpp::shutdown();
  }
  /// ROS time, after the beginning of the test [s].
  static void go_to(double seconds) { rehearse_ros2::set_ros_time(date + static_cast<std::int64_t>(seconds * 1e9)); }
  static Int32 number(int value) {
    Int32 message;
    message.data = value;
    return message;
  }
  rclcpp::Node::SharedPtr node;
  std::optional<rclcpp::executors::SingleThreadedExecutor> executor;
};

using Numbers = std::vector<int>;

// Time.

TEST_F(ClientLibrary, TimesOfTwoKindsOfClocksAreNotCompared) {
  const rclcpp::Time ros = node->now(), steady = rclcpp::Clock(RCL_STEADY_TIME).now();
  EXPECT_THROW((void)(ros < steady), std::runtime_error);
  EXPECT_THROW((void)(ros - steady), std::runtime_error);
  EXPECT_EQ(rclcpp::Time(std::int64_t{5}).get_clock_type(), RCL_SYSTEM_TIME);
  EXPECT_EQ(rclcpp::Time(builtin_interfaces::msg::Time()).get_clock_type(), RCL_ROS_TIME);
}

TEST_F(ClientLibrary, TheEpochsOfClocksDiffer) {
  EXPECT_GT(std::abs(node->now().nanoseconds() - rclcpp::Clock(RCL_STEADY_TIME).now().nanoseconds()), 3600 * second);
}

TEST_F(ClientLibrary, SumsThatDoNotFitThrow) {
  EXPECT_THROW(rclcpp::Time::max() + rclcpp::Duration(0, 1), std::overflow_error);
  EXPECT_THROW(rclcpp::Duration::from_nanoseconds(std::numeric_limits<std::int64_t>::min()) - rclcpp::Duration(0, 1),
               std::underflow_error);
  EXPECT_THROW(rclcpp::Duration::max() * 2.0, std::overflow_error);
  EXPECT_EQ(rclcpp::Duration::from_seconds(-0.5).nanoseconds(), -second / 2);
  const builtin_interfaces::msg::Duration message = rclcpp::Duration::from_seconds(-0.5);
  EXPECT_EQ(message.sec, -1);
  EXPECT_EQ(message.nanosec, 500'000'000u);
}

TEST_F(ClientLibrary, ALateRateDoesNotSleep) {
  rclcpp::Rate rate(rclcpp::Duration(10, 0), node->get_clock());
  go_to(15.0);
  EXPECT_FALSE(rate.sleep());
}

// Timers.

TEST_F(ClientLibrary, ATimerIsCalledOnceAPeriod) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  go_to(11.0);
  executor->spin_some();
  executor->spin_some();
  EXPECT_EQ(calls, 1);
  go_to(21.0);
  executor->spin_some();
  EXPECT_EQ(calls, 2);
}

TEST_F(ClientLibrary, ATimerThatIsLateByWholePeriodsIsCalledOnce) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  go_to(35.0);
  executor->spin_all(0s);
  EXPECT_EQ(calls, 1);
  EXPECT_NEAR(std::chrono::duration<double>(timer->time_until_trigger()).count(), 5.0, 1.0);
}

TEST_F(ClientLibrary, ACancelledTimerIsNotCalledUntilItIsReset) {
  int calls = 0;
  const auto timer = node->create_timer(10s, [&] { ++calls; });
  timer->cancel();
  EXPECT_TRUE(timer->is_canceled());
  go_to(30.0);
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  timer->reset();
  go_to(39.0);
  executor->spin_some();
  EXPECT_EQ(calls, 0);
  go_to(41.0);
  executor->spin_some();
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, ATimerThatCancelsItselfIsCalledOnce) {
  int calls = 0;
  rclcpp::TimerBase::SharedPtr timer = node->create_timer(1s, [&](rclcpp::TimerBase& self) {
    ++calls;
    self.cancel();
  });
  for (int i = 1; i < 4; ++i) {
    go_to(i);
    executor->spin_some();
  }
  EXPECT_EQ(calls, 1);
}

TEST_F(ClientLibrary, ANegativePeriodIsRefused) {
  EXPECT_THROW((void)node->create_wall_timer(-1s, [] {}), std::invalid_argument);
}

// Topics.

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

// Executors.

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
  std::atomic<int> calls{0};
  const auto subscription = node->create_subscription<Int32>("t", 5, [&](const Int32&) {
    ++calls;
    executor->cancel();
  });
  std::thread spinning([&] { executor->spin(); });
  node->create_publisher<Int32>("t", 5)->publish(number(1));
  spinning.join();
  EXPECT_EQ(calls, 1);
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

// Services.

TEST_F(ClientLibrary, AServiceAnswers) {
  const auto service = node->create_service<std_srvs::srv::SetBool>(
      "s",
      [](std_srvs::srv::SetBool::Request::SharedPtr request, std_srvs::srv::SetBool::Response::SharedPtr response) {
        response->success = request->data;
        response->message = "heard";
      });
  const auto client = node->create_client<std_srvs::srv::SetBool>("s");
  EXPECT_TRUE(client->wait_for_service(0s));
  auto request = std::make_shared<std_srvs::srv::SetBool::Request>();
  request->data = true;
  auto future = client->async_send_request(request);
  EXPECT_EQ(executor->spin_until_future_complete(future), rclcpp::FutureReturnCode::SUCCESS);
  const auto response = future.get();
  EXPECT_TRUE(response->success);
  EXPECT_EQ(response->message, "heard");
}

TEST_F(ClientLibrary, AServiceMayAnswerLater) {
  std::shared_ptr<rmw_request_id_t> asked;
  const auto service = node->create_service<std_srvs::srv::Trigger>(
      "s",
      [&](std::shared_ptr<rmw_request_id_t> header, std_srvs::srv::Trigger::Request::SharedPtr) { asked = header; });
  const auto client = node->create_client<std_srvs::srv::Trigger>("s");
  auto future = client->async_send_request(std::make_shared<std_srvs::srv::Trigger::Request>());
  EXPECT_EQ(executor->spin_until_future_complete(future, 1ms), rclcpp::FutureReturnCode::TIMEOUT);
  ASSERT_TRUE(asked);
  std_srvs::srv::Trigger::Response response;
  response.success = true;
  service->send_response(*asked, response);
  EXPECT_EQ(executor->spin_until_future_complete(future), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_TRUE(future.get()->success);
}

TEST_F(ClientLibrary, ARequestToNobodyTimesOut) {
  const auto client = node->create_client<std_srvs::srv::Trigger>("nobody");
  EXPECT_FALSE(client->wait_for_service(1ms));
  auto future = client->async_send_request(std::make_shared<std_srvs::srv::Trigger::Request>());
  EXPECT_EQ(executor->spin_until_future_complete(future, 1ms), rclcpp::FutureReturnCode::TIMEOUT);
  EXPECT_TRUE(client->remove_pending_request(future));
}

// Parameters.

TEST_F(ClientLibrary, AParameterIsDeclaredOnce) {
  EXPECT_EQ(node->declare_parameter("gain", 2.5), 2.5);
  EXPECT_EQ(node->declare_parameter("name", "arm"), "arm");
  EXPECT_THROW(node->declare_parameter("gain", 1.0), rclcpp::exceptions::ParameterAlreadyDeclaredException);
  EXPECT_THROW((void)node->get_parameter("other"), rclcpp::exceptions::ParameterNotDeclaredException);
  EXPECT_THROW((void)node->set_parameter(rclcpp::Parameter("other", 1)),
               rclcpp::exceptions::ParameterNotDeclaredException);
  EXPECT_FALSE(node->set_parameter(rclcpp::Parameter("gain", "much")).successful);
  EXPECT_THROW((void)node->get_parameter("gain").as_string(), rclcpp::exceptions::InvalidParameterTypeException);
}

TEST_F(ClientLibrary, AParameterWithoutAValueIsUninitialised) {
  EXPECT_THROW(node->declare_parameter<double>("gain"), rclcpp::exceptions::ParameterUninitializedException);
  EXPECT_TRUE(node->has_parameter("gain"));
  EXPECT_THROW((void)node->get_parameter("gain"), rclcpp::exceptions::ParameterUninitializedException);
  EXPECT_TRUE(node->set_parameter(rclcpp::Parameter("gain", 3.0)).successful);
  EXPECT_EQ(node->get_parameter("gain").as_double(), 3.0);
}

TEST_F(ClientLibrary, RangesAndReadOnlyParametersRefuseValues) {
  rcl_interfaces::msg::ParameterDescriptor ranged, fixed;
  ranged.floating_point_range.resize(1);
  ranged.floating_point_range[0].from_value = 0.0;
  ranged.floating_point_range[0].to_value = 1.0;
  ranged.floating_point_range[0].step = 0.25;
  fixed.read_only = true;
  node->declare_parameter("share", 0.5, ranged);
  node->declare_parameter("fixed", 1, fixed);
  EXPECT_TRUE(node->set_parameter(rclcpp::Parameter("share", 0.75)).successful);
  EXPECT_FALSE(node->set_parameter(rclcpp::Parameter("share", 0.8)).successful);
  EXPECT_FALSE(node->set_parameter(rclcpp::Parameter("share", 1.25)).successful);
  EXPECT_FALSE(node->set_parameter(rclcpp::Parameter("fixed", 2)).successful);
  EXPECT_THROW(node->declare_parameter("wrong", 2.0, ranged), rclcpp::exceptions::InvalidParameterValueException);
}

TEST_F(ClientLibrary, CallbacksOfParametersAreCalledInOrder) {
  node->declare_parameter("a", 1);
  std::string order;
  const auto pre = node->add_pre_set_parameters_callback([&](std::vector<rclcpp::Parameter>&) { order += "pre "; });
  const auto on = node->add_on_set_parameters_callback([&](const std::vector<rclcpp::Parameter>& all) {
    order += "on ";
    rcl_interfaces::msg::SetParametersResult result;
    result.successful = all[0].as_int() > 0;
    result.reason = "not positive";
    return result;
  });
  const auto post =
      node->add_post_set_parameters_callback([&](const std::vector<rclcpp::Parameter>&) { order += "post "; });
  EXPECT_TRUE(node->set_parameter(rclcpp::Parameter("a", 2)).successful);
  EXPECT_EQ(order, "pre on post ");
  order.clear();
  const auto result = node->set_parameter(rclcpp::Parameter("a", -2));
  EXPECT_FALSE(result.successful);
  EXPECT_EQ(result.reason, "not positive");
  EXPECT_EQ(order, "pre on ");
  EXPECT_EQ(node->get_parameter("a").as_int(), 2);
}

TEST_F(ClientLibrary, ACallbackOfParametersMayNotSetThem) {
  node->declare_parameter("a", 1);
  const auto on = node->add_on_set_parameters_callback([&](const std::vector<rclcpp::Parameter>&) {
    rcl_interfaces::msg::SetParametersResult result;
    node->set_parameter(rclcpp::Parameter("a", 3));
    result.successful = true;
    return result;
  });
  EXPECT_THROW(node->set_parameter(rclcpp::Parameter("a", 2)),
               rclcpp::exceptions::ParameterModifiedInCallbackException);
}

TEST_F(ClientLibrary, AnAtomicSetSetsAllOrNone) {
  node->declare_parameter("a", 1);
  node->declare_parameter("b", 1);
  EXPECT_FALSE(node->set_parameters_atomically({rclcpp::Parameter("a", 2), rclcpp::Parameter("b", "x")}).successful);
  EXPECT_EQ(node->get_parameter("a").as_int(), 1);
}

TEST_F(ClientLibrary, FilesOfParametersHaveWildcardsAndRemaps) {
  const std::string file = ::testing::TempDir() + "parameters.yaml";
  std::ofstream(file) << "/**:\n  ros__parameters: {gain: 1.5, list: [1, 2], deep: {on: true}, text: '7'}\n"
                         "/left/*:\n  ros__parameters: {gain: 2.5}\n"
                         "/right/arm:\n  ros__parameters: {gain: 3.5}\n";
  rclcpp::NodeOptions options;
  options.arguments({"--ros-args", "--params-file", file, "-r", "__ns:=/left", "-r", "in:=/joint_states", "-p",
                     "extra:=[a, b]", "-r", "other:__node:=never"});
  rclcpp::Node arm("arm", options);
  EXPECT_STREQ(arm.get_fully_qualified_name(), "/left/arm");
  EXPECT_EQ(arm.declare_parameter("gain", 0.0), 2.5);
  EXPECT_EQ(arm.declare_parameter<std::vector<std::int64_t>>("list"), (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(arm.declare_parameter("deep.on", false));
  EXPECT_EQ(arm.declare_parameter("text", ""), "7");
  EXPECT_EQ(arm.declare_parameter<std::vector<std::string>>("extra"), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(arm.create_publisher<Int32>("in", 1)->get_topic_name(), std::string("/joint_states"));
  EXPECT_THROW(arm.declare_parameter("gain2", rclcpp::PARAMETER_NOT_SET), std::invalid_argument);
  EXPECT_THROW(rclcpp::Node("x", rclcpp::NodeOptions().arguments({"--ros-args", "-p", "no_value"})),
               rclcpp::exceptions::RCLInvalidROSArgsError);
}

TEST_F(ClientLibrary, NamesAreChecked) {
  EXPECT_THROW(rclcpp::Node("a b"), rclcpp::exceptions::InvalidNodeNameError);
  EXPECT_THROW(rclcpp::Node("1a"), rclcpp::exceptions::InvalidNodeNameError);
  EXPECT_THROW((void)node->create_publisher<Int32>("a-b", 1), rclcpp::exceptions::InvalidTopicNameError);
  EXPECT_EQ(node->create_publisher<Int32>("~/t", 1)->get_topic_name(), std::string("/node/t"));
}

TEST_F(ClientLibrary, ParametersAreSetByServices) {
  node->declare_parameter("gain", 1.0);
  const auto client = node->create_client<rcl_interfaces::srv::SetParameters>("node/set_parameters");
  auto request = std::make_shared<rcl_interfaces::srv::SetParameters::Request>();
  request->parameters.push_back(rclcpp::Parameter("gain", 4.0).to_parameter_msg());
  auto future = client->async_send_request(request);
  ASSERT_EQ(executor->spin_until_future_complete(future), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_TRUE(future.get()->results.at(0).successful);
  EXPECT_EQ(node->get_parameter("gain").as_double(), 4.0);
}

// Actions.

using Lookup = tf2_msgs::action::LookupTransform;
using ServerHandle = rclcpp_action::ServerGoalHandle<Lookup>;

class Actions : public ClientLibrary {
 protected:
  void SetUp() override {
    ClientLibrary::SetUp();
    server = rclcpp_action::create_server<Lookup>(
        node, "lookup",
        [](const rclcpp_action::GoalUUID&, std::shared_ptr<const Lookup::Goal> goal) {
          return goal->target_frame == "no" ? rclcpp_action::GoalResponse::REJECT
                                            : rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [this](std::shared_ptr<ServerHandle>) {
          return may_cancel ? rclcpp_action::CancelResponse::ACCEPT : rclcpp_action::CancelResponse::REJECT;
        },
        [this](std::shared_ptr<ServerHandle> handle) { goal_handle = handle; });
    client = rclcpp_action::create_client<Lookup>(node, "lookup");
  }
  void TearDown() override {
    goal_handle.reset();
    client.reset();
    server.reset();
    ClientLibrary::TearDown();
  }
  rclcpp_action::ClientGoalHandle<Lookup>::SharedPtr send(const std::string& frame) {
    Lookup::Goal goal;
    goal.target_frame = frame;
    rclcpp_action::Client<Lookup>::SendGoalOptions options;
    options.feedback_callback = [this](auto, auto) { ++feedback; };
    options.result_callback = [this](const auto& result) { code = result.code; };
    const auto future = client->async_send_goal(goal, options);
    executor->spin_until_future_complete(future);
    return future.get();
  }
  std::shared_ptr<ServerHandle> goal_handle;
  rclcpp_action::Server<Lookup>::SharedPtr server;
  rclcpp_action::Client<Lookup>::SharedPtr client;
  bool may_cancel = true;
  int feedback = 0;
  rclcpp_action::ResultCode code = rclcpp_action::ResultCode::UNKNOWN;
};

TEST_F(Actions, AGoalSucceedsWithFeedback) {
  const auto goal = send("base");
  ASSERT_TRUE(goal && goal_handle && goal_handle->is_executing());
  goal_handle->publish_feedback(std::make_shared<Lookup::Feedback>());
  auto result = std::make_shared<Lookup::Result>();
  result->transform.child_frame_id = "hand";
  goal_handle->succeed(result);
  const auto future = client->async_get_result(goal);
  ASSERT_EQ(executor->spin_until_future_complete(future), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_EQ(future.get().code, rclcpp_action::ResultCode::SUCCEEDED);
  EXPECT_EQ(future.get().result->transform.child_frame_id, "hand");
  EXPECT_EQ(feedback, 1);
  EXPECT_EQ(code, rclcpp_action::ResultCode::SUCCEEDED);
  EXPECT_THROW(goal_handle->succeed(result), rclcpp::exceptions::RCLError);
}

TEST_F(Actions, ARejectedGoalHasNoHandle) { EXPECT_EQ(send("no"), nullptr); }

TEST_F(Actions, AGoalIsCancelled) {
  const auto goal = send("base");
  const auto answer = client->async_cancel_goal(goal);
  ASSERT_EQ(executor->spin_until_future_complete(answer), rclcpp::FutureReturnCode::SUCCESS);
  EXPECT_EQ(answer.get()->return_code, action_msgs::srv::CancelGoal::Response::ERROR_NONE);
  ASSERT_TRUE(goal_handle->is_canceling());
  goal_handle->canceled(std::make_shared<Lookup::Result>());
  executor->spin_all(0s);
  EXPECT_EQ(code, rclcpp_action::ResultCode::CANCELED);
}

TEST_F(Actions, ACancellationMayBeRefused) {
  may_cancel = false;
  const auto goal = send("base");
  const auto answer = client->async_cancel_goal(goal);
  executor->spin_until_future_complete(answer);
  EXPECT_EQ(answer.get()->return_code, action_msgs::srv::CancelGoal::Response::ERROR_REJECTED);
  EXPECT_TRUE(goal_handle->is_executing());
}

TEST_F(Actions, AGoalWhoseHandleIsDroppedIsCancelled) {
  send("base");
  goal_handle.reset();
  executor->spin_all(0s);
  EXPECT_EQ(code, rclcpp_action::ResultCode::CANCELED);
}

// Lifecycle.

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
}

// Encoding.

TEST_F(ClientLibrary, EveryKindOfFieldIsDecodedAsItWasEncoded) {
  sensor_msgs::msg::JointState message;
  message.header.frame_id = "base";
  message.name = {"a", "", "hinge"};
  message.position = {1.0, -2.5};
  const auto& type = rehearse_ros2::members_of<sensor_msgs::msg::JointState>();
  std::vector<std::uint8_t> bytes;
  rehearse_ros2::encode(&message, type, bytes);
  sensor_msgs::msg::JointState decoded;
  rehearse_ros2::decode(bytes.data(), bytes.size(), type, &decoded);
  EXPECT_EQ(decoded, message);
  EXPECT_EQ(rehearse_ros2::type_name_of(type), "sensor_msgs/msg/JointState");
  EXPECT_NE(rehearse_ros2::definition_of(type).find("std_msgs/Header header\nstring[] name\n"), std::string::npos);
  rcl_interfaces::msg::ParameterValue value, decoded_value;
  value.bool_array_value = {true, false, true};
  value.integer_array_value = {-1, 1};
  const auto& value_type = rehearse_ros2::members_of<rcl_interfaces::msg::ParameterValue>();
  rehearse_ros2::encode(&value, value_type, bytes);
  rehearse_ros2::decode(bytes.data(), bytes.size(), value_type, &decoded_value);
  EXPECT_EQ(decoded_value, value);
}

TEST_F(ClientLibrary, BytesThatAreNoMessageAreRefused) {
  sensor_msgs::msg::JointState message;
  message.name = {"a", "b"};
  message.position = {1.0, 2.0};
  const auto& type = rehearse_ros2::members_of<sensor_msgs::msg::JointState>();
  std::vector<std::uint8_t> bytes;
  rehearse_ros2::encode(&message, type, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    sensor_msgs::msg::JointState decoded;
    const std::vector<std::uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(rehearse_ros2::decode(cut.data(), cut.size(), type, &decoded), rehearse_ros2::DecodingError) << size;
  }
  // A length of 4 billion takes no memory.
  for (std::size_t place = 4; place + 4 <= bytes.size(); ++place) {
    std::vector<std::uint8_t> changed = bytes;
    std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(place), 4, 0xff);
    sensor_msgs::msg::JointState decoded;
    try {
      rehearse_ros2::decode(changed.data(), changed.size(), type, &decoded);
    } catch (const rehearse_ros2::DecodingError&) {
    }
    EXPECT_LE(decoded.name.size() + decoded.position.size(), bytes.size());
  }
}

// Logs.

TEST_F(ClientLibrary, AThrottledLineWaitsForItsClock) {
  int count = 0;
  const auto line = [&] {
    RCLCPP_INFO_STREAM_THROTTLE(node->get_logger(), *node->get_clock(), 10000, "line " << ++count);
  };
  node->get_logger().set_level(rclcpp::Logger::Level::Info);
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  line();
  line();
  EXPECT_EQ(count, 1);
  go_to(11.0);
  line();
  EXPECT_EQ(count, 2);
  testing::internal::GetCapturedStdout();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("[node]"), std::string::npos);
}

}  // namespace
