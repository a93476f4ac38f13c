# Logs of real robots as inputs of controllers. A library of its own, because pictures in logs are JPEGs.
find_package(JPEG REQUIRED)

rehearse_add_library(log
  src/log/log_map.cpp
  src/log/log_map_sources.cpp
  src/log/log_topics.cpp)
target_link_libraries(rehearse_log
  PUBLIC Rehearse::harness
  PRIVATE Rehearse::png JPEG::JPEG fmt::fmt)
