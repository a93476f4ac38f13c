# The buffer is that of tf2, a package of the user's workspace.
find_package(tf2 QUIET)
if(tf2_FOUND)
  target_link_libraries(tf2_ros::tf2_ros INTERFACE tf2::tf2)
endif()
