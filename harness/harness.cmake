# What runs and judges controllers without simulating anything.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_package(Threads REQUIRED)

rehearse_add_library(harness
  src/camera_info.cpp
  src/cnoid_body.cpp
  src/contact_recorder.cpp
  src/controller_host.cpp
  src/controller_io.cpp
  src/usable_outputs.cpp
  src/info_text.cpp
  src/controller_library.cpp
  src/device_recorder.cpp
  src/divergence.cpp
  src/float_mode.cpp
  src/guarded_call.cpp
  src/hashing.cpp
  src/host_joystick.cpp
  src/io_body.cpp
  src/joint_arrays.cpp
  src/mesh_digests.cpp
  src/output_record.cpp
  src/pin.cpp
  src/process_guard.cpp
  src/process_tripwires.cpp
  src/provenance.cpp
  src/recorded_inputs.cpp
  src/recorded_outputs.cpp
  src/recorder.cpp
  src/replay.cpp
  src/trace_scenario.cpp)
target_include_directories(rehearse_harness PRIVATE ${XXHASH_INCLUDE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/src)
target_compile_definitions(rehearse_harness PRIVATE REHEARSE_VERSION="${PROJECT_VERSION}")
set_source_files_properties(src/provenance.cpp PROPERTIES
  COMPILE_DEFINITIONS REHEARSE_OTHER_FLAGS="${REHEARSE_OTHER_FLAGS}")
target_link_libraries(rehearse_harness
  PUBLIC Rehearse::scenario Rehearse::trace
  PRIVATE Rehearse::cnoid Rehearse::png fmt::fmt Threads::Threads ${CMAKE_DL_LIBS})
