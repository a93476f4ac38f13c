# Launch files are programs in Python on rclpy, which is not part of this underlay.
function(add_launch_test file)
  message(STATUS "launch test left out: ${file}")
endfunction()
