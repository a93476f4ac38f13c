find_package(JPEG REQUIRED)

rehearse_add_test(log_test LABEL unit SHARDS 2
  SOURCES
    log/clocks_test.cpp
    log/encodings_test.cpp
    log/faithful_test.cpp
    log/feeds_test.cpp
    log/joint_messages_test.cpp
    log/map_broken_test.cpp
    log/map_test.cpp
    log/pictures_test.cpp
    log/ranges_test.cpp
    log/replay_log_test.cpp
    log/robot_run_test.cpp
    log/stretches_test.cpp
    log/ticks_test.cpp
    log/watch_test.cpp
  LIBRARIES Rehearse::logs Rehearse::testing JPEG::JPEG fmt::fmt)
# Logs of each form: the more, the more gaps and orders of their messages.
include(RehearseControllers)
foreach(servo With_none With_filtered With_integral WithoutState WithPartOfState)
  rehearse_add_simple_controller(Servo${servo} log/controllers/servo.cpp)
  string(REPLACE With_ "" memory ${servo})
  string(REGEX REPLACE "Without.*|WithPart.*" integral memory ${memory})
  set(numbers 2)  # of each joint that the controller takes back
  if(servo STREQUAL WithoutState)
    set(numbers 0)
  elseif(servo STREQUAL WithPartOfState)
    set(numbers 1)
  endif()
  target_compile_definitions(Servo${servo} PRIVATE MEMORY=${memory} TAKEN_NUMBERS=${numbers})
  set_target_properties(Servo${servo} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${test_controllers})
  add_dependencies(log_test Servo${servo})
endforeach()
rehearse_add_test(kinds_test LABEL unit SHARDS 2
  SOURCES log/kinds.cpp log/kinds_list.cpp log/kinds_test.cpp
  LIBRARIES Rehearse::logs Rehearse::testing sqlite3 zstd)
target_compile_definitions(kinds_test PRIVATE TEST_CONTROLLERS="${test_controllers}" AT_NIGHT=$<BOOL:${REHEARSE_NIGHTLY}>)
add_dependencies(kinds_test ServoWith_none ServoWith_filtered ServoWith_integral)
target_compile_definitions(log_test PRIVATE TEST_CONTROLLERS="${test_controllers}" LOGS=$<IF:$<BOOL:${REHEARSE_NIGHTLY}>,50,20>)
add_dependencies(log_test CameraFollowerController RoverController SR1MinimumController ScoutController TankController TrotController)

# A bag that others recorded isn't part of this repository, so without it the test is skipped.
set(REHEARSE_PUBLIC_BAG "" CACHE PATH "A folder of rosbag2 with /turtle1/cmd_vel of turtlesim")
rehearse_add_simple_controller(TwistDriver log/controllers/twist_driver.cpp)
set_target_properties(TwistDriver PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${test_controllers})
rehearse_add_test(public_bag_test LABEL compat SOURCES log/public_bag_test.cpp
  LIBRARIES Rehearse::logs Rehearse::testing sqlite3)
target_compile_definitions(public_bag_test PRIVATE PUBLIC_BAG="${REHEARSE_PUBLIC_BAG}"
  TEST_CONTROLLERS="${test_controllers}")
add_dependencies(public_bag_test TwistDriver)
