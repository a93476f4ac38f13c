// Names of nodes and topics.
#include "client_library.h"

namespace {

TEST_F(ClientLibrary, NamesAreChecked) {
  EXPECT_THROW(rclcpp::Node("a b"), rclcpp::exceptions::InvalidNodeNameError);
  EXPECT_THROW(rclcpp::Node("1a"), rclcpp::exceptions::InvalidNodeNameError);
  EXPECT_THROW((void)node->create_publisher<Int32>("a-b", 1), rclcpp::exceptions::InvalidTopicNameError);
  EXPECT_EQ(node->create_publisher<Int32>("~/t", 1)->get_topic_name(), std::string("/node/t"));
}

}  // namespace
