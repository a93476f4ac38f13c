# The host reports crashes with their place; a second handler would take its signals.
if(NOT TARGET Backward::Backward)
  add_library(Backward::Backward INTERFACE IMPORTED)
endif()
if(NOT TARGET backward_ros::backward_ros)
  add_library(backward_ros::backward_ros INTERFACE IMPORTED)
endif()
