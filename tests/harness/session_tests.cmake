include(RehearseControllers)

# Controllers for these tests, in a separate folder. Their errors are intended, so they are built without sanitizers.
set(test_controllers ${CMAKE_BINARY_DIR}/tests/controllers)
function(add_test_controller name)
  rehearse_add_simple_controller(${name} ${ARGN})
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${test_controllers})
  if(REHEARSE_SANITIZE)
    target_compile_options(${name} PRIVATE -fno-sanitize=all)
  endif()
  add_dependencies(session_tests ${name})
endfunction()

rehearse_add_test(session_tests LABEL sim SHARDS 6
  SOURCES
    session/acting_devices_test.cpp
    session/actuation_test.cpp
    session/actuators_test.cpp
    session/body_loading_test.cpp
    session/branch_test.cpp
    session/choreonoid_items_test.cpp
    session/code_hashes_test.cpp
    session/contacts_test.cpp
    session/control_times_test.cpp
    session/controller_watch_test.cpp
    session/expectation_spans_test.cpp
    session/failures_test.cpp
    session/fixed_message_test.cpp
    session/golden_samples_test.cpp
    session/hardware_test.cpp
    session/joystick_test.cpp
    session/lifecycle_test.cpp
    session/lights_test.cpp
    session/magnetometer_test.cpp
    session/noise_test.cpp
    session/one_judge_test.cpp
    session/opened_files_test.cpp
    session/other_physics_test.cpp
    session/other_processor_test.cpp
    session/partial_acceptance_test.cpp
    session/plant_test.cpp
    session/process_guard_test.cpp
    session/range_sensors_test.cpp
    session/recording_test.cpp
    session/replay_test.cpp
    session/reproduction_test.cpp
    session/run_test.cpp
    session/self_collision_test.cpp
    session/sensor_errors_test.cpp
    session/source_age_test.cpp
    session/traps_test.cpp
    session/words_test.cpp
    session/world_remarks_test.cpp
  LIBRARIES Rehearse::simulation Rehearse::harness Rehearse::logs Rehearse::simulation Rehearse::cnoid)
target_include_directories(session_tests PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(session_tests PRIVATE
  CXX_COMPILER="${CMAKE_CXX_COMPILER}" TEST_CONTROLLERS="${test_controllers}"
  SAMPLE_CONTROLLERS="$<TARGET_FILE_DIR:TrotController>")
add_dependencies(session_tests TrotController)

# Controllers with threads.
find_package(Threads REQUIRED)
rehearse_add_test(turns_test LABEL sim SHARDS 3 SOURCES session/turns_test.cpp
  LIBRARIES Rehearse::simulation Rehearse::harness Rehearse::cnoid)
target_include_directories(turns_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(turns_test PRIVATE TEST_CONTROLLERS="${test_controllers}")
add_test_controller(Threads controllers/behaviours.cpp controllers/threads.cpp)
target_link_libraries(Threads PRIVATE Threads::Threads rehearse_flags)
add_dependencies(turns_test Threads)

add_test_controller(Behaviours
  controllers/behaviours.cpp controllers/contacts.cpp controllers/devices.cpp controllers/failures.cpp
  controllers/inputs.cpp controllers/joysticks.cpp controllers/lifecycle.cpp controllers/models.cpp controllers/threads.cpp controllers/trespasses.cpp
  controllers/words.cpp)
target_link_libraries(Behaviours PRIVATE Threads::Threads)
target_link_libraries(Behaviours PRIVATE rehearse_flags)
add_test_controller(HingePd controllers/HingePd.cpp)
add_test_controller(HingePdChanged controllers/HingePd.cpp)
target_compile_definitions(HingePdChanged PRIVATE CHANGED_FROM_TICK=70)
add_test_controller(HingePdWithEffort controllers/HingePd.cpp)
target_compile_definitions(HingePdWithEffort PRIVATE EFFORT_GAIN=0.5)
add_test_controller(LoadsBadly controllers/LoadsBadly.cpp)
add_test_controller(FastMath controllers/FastMath.cpp)
target_link_libraries(FastMath PRIVATE $<1:-ffast-math>)  # on purpose: not to be warned of

# Robots of other projects, dropped and held: cmake -DREHEARSE_EXAMPLE_ROBOTS=DIR, a checkout of example-robot-data.
find_package(fmt REQUIRED)
set(REHEARSE_EXAMPLE_ROBOTS "" CACHE PATH "A checkout of example-robot-data, whose robots are to be simulated")
rehearse_add_test(robots_checkout_test LABEL compat TIMEOUT 300 SOURCES robots_checkout_test.cpp
                  LIBRARIES Rehearse::simulation fmt::fmt)
target_compile_definitions(robots_checkout_test PRIVATE EXAMPLE_ROBOTS="${REHEARSE_EXAMPLE_ROBOTS}"
                           TEST_CONTROLLERS="${test_controllers}")
add_dependencies(robots_checkout_test Behaviours)

rehearse_add_test(allocations_test LABEL sim SHARDS 1 SOURCES allocations_test.cpp
                  LIBRARIES Rehearse::simulation Rehearse::cnoid)
