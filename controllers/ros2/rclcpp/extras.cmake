# A guest is linked with this library even if it calls nothing of it.
include("${rclcpp_DIR}/public_names.cmake")
