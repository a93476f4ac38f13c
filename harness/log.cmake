# Logs of real robots as inputs of controllers. A library of its own, because pictures in logs are JPEGs.
find_package(JPEG REQUIRED)

# The maps' reader needs no more than scenarios do; its fuzzer is built of that alone.
add_library(rehearse_log_map OBJECT src/log_map/log_map.cpp src/log_map/log_map_sources.cpp src/log_map/log_topics.cpp)
target_include_directories(rehearse_log_map PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
target_link_libraries(rehearse_log_map PUBLIC Rehearse::scenario Rehearse::trace PRIVATE rehearse_flags yaml-cpp fmt::fmt)

rehearse_add_library(log
  $<TARGET_OBJECTS:rehearse_log_map>
  src/log/device_feeds.cpp
  src/log/joint_feed.cpp
  src/log/log_commands.cpp
  src/log/log_observations.cpp
  src/log/log_replay.cpp
  src/log/log_requirements.cpp
  src/log/log_scenario.cpp
  src/log/log_survey.cpp
  src/log/picture_codecs.cpp
  src/log/range_codecs.cpp
  src/log/topic_watch.cpp)
target_link_libraries(rehearse_log
  PUBLIC Rehearse::harness
  PRIVATE Rehearse::cnoid Rehearse::png JPEG::JPEG yaml-cpp fmt::fmt)
