# The other packages list public names of their headers, too.
include("${rclcpp_DIR}/public_names.cmake")
