// Parameters, and the files and arguments that state them.
#include <fstream>
#include <rcl_interfaces/srv/set_parameters.hpp>

#include "client_library.h"

namespace {

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

}  // namespace
