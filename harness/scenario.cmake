find_package(yaml-cpp 0.7 REQUIRED)
find_package(fmt REQUIRED)

rehearse_add_library(scenario
  src/scenario/joystick_script.cpp src/scenario/normal_quantile.cpp src/scenario/sensor_noise.cpp src/scenario/tolerance.cpp
  src/scenario/scenario.cpp src/scenario/scenario_bodies.cpp src/scenario/scenario_controllers.cpp src/scenario/scenario_expectations.cpp
  src/scenario/scenario_findings.cpp
  src/scenario/scenario_joints.cpp src/scenario/scenario_joystick.cpp src/scenario/scenario_noise.cpp src/scenario/scenario_references.cpp src/scenario/scenario_values.cpp
  src/scenario/scenario_yaml.cpp)
target_include_directories(rehearse_scenario PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rehearse_scenario PUBLIC Rehearse::model PRIVATE yaml-cpp fmt::fmt)
