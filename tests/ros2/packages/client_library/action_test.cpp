// Actions.
#include <rclcpp_action/rclcpp_action.hpp>
#include <tf2_msgs/action/lookup_transform.hpp>

#include "client_library.h"

namespace {

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

TEST_F(Actions, AGoalToNobodyIsNotAnswered) {
  const auto nobody = rclcpp_action::create_client<Lookup>(node, "nobody");
  EXPECT_FALSE(nobody->wait_for_action_server(1ms));
  const auto future = nobody->async_send_goal(Lookup::Goal());
  EXPECT_EQ(executor->spin_until_future_complete(future, 1ms), rclcpp::FutureReturnCode::TIMEOUT);
}

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

}  // namespace
