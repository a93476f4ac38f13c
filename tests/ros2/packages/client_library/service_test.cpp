// Services and clients.
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <thread>

#include "client_library.h"

namespace {

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

TEST_F(ClientLibrary, AServiceThatComesLaterIsWaitedFor) {
  const auto client = node->create_client<std_srvs::srv::Trigger>("s");
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr service;
  std::thread later([&] {
    rclcpp::sleep_for(20ms);
    service = node->create_service<std_srvs::srv::Trigger>(
        "s", [](std_srvs::srv::Trigger::Request::SharedPtr, std_srvs::srv::Trigger::Response::SharedPtr) {});
  });
  EXPECT_TRUE(client->wait_for_service(std::chrono::nanoseconds::max()));
  later.join();
}

TEST_F(ClientLibrary, ARequestToNobodyTimesOut) {
  const auto client = node->create_client<std_srvs::srv::Trigger>("nobody");
  EXPECT_FALSE(client->wait_for_service(1ms));
  auto future = client->async_send_request(std::make_shared<std_srvs::srv::Trigger::Request>());
  EXPECT_EQ(executor->spin_until_future_complete(future, 1ms), rclcpp::FutureReturnCode::TIMEOUT);
  EXPECT_TRUE(client->remove_pending_request(future));
}

}  // namespace
