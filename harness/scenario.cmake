find_package(yaml-cpp 0.7 REQUIRED)
find_package(fmt REQUIRED)

rehearse_add_library(scenario
  src/joystick_script.cpp src/normal_quantile.cpp src/sensor_noise.cpp src/tolerance.cpp
  src/scenario.cpp src/scenario_bodies.cpp src/scenario_controllers.cpp src/scenario_expectations.cpp
  src/scenario_findings.cpp
  src/scenario_joints.cpp src/scenario_joystick.cpp src/scenario_noise.cpp src/scenario_references.cpp src/scenario_values.cpp
  src/scenario_yaml.cpp)
target_include_directories(rehearse_scenario PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(rehearse_scenario PUBLIC Rehearse::model PRIVATE yaml-cpp fmt::fmt)
