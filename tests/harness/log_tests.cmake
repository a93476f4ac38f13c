find_package(JPEG REQUIRED)

rehearse_add_test(log_test LABEL unit SHARDS 2
  SOURCES
    log/clocks_test.cpp
    log/faithful_test.cpp
    log/feeds_test.cpp
    log/joint_messages_test.cpp
    log/map_broken_test.cpp
    log/map_test.cpp
    log/pictures_test.cpp
    log/replay_log_test.cpp
    log/robot_run_test.cpp
    log/ticks_test.cpp
    log/watch_test.cpp
  LIBRARIES Rehearse::log Rehearse::testing JPEG::JPEG)
add_dependencies(log_test CameraFollowerController RoverController SR1MinimumController ScoutController TankController TrotController)
