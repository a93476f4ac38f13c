# What runs and judges controllers without simulating anything.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_package(Threads REQUIRED)

rehearse_add_library(harness
  src/recording/camera_info.cpp
  src/host/cnoid_body.cpp
  src/recording/contact_recorder.cpp
  src/host/controller_host.cpp
  src/host/controller_io.cpp
  src/host/usable_outputs.cpp
  src/host/info_text.cpp
  src/host/controller_library.cpp
  src/host/debug_hook.cpp
  src/recording/device_recorder.cpp
  src/compare/divergence.cpp
  src/compare/series_scale.cpp
  src/host/file_tripwires.cpp
  src/host/float_mode.cpp
  src/host/guarded_call.cpp
  src/host/host_joystick.cpp
  src/host/io_body.cpp
  src/host/interruption.cpp
  src/host/joint_arrays.cpp
  src/recording/mesh_digests.cpp
  src/replay/output_record.cpp
  src/host/opened_files.cpp
  src/host/pin.cpp
  src/host/process_guard.cpp
  src/host/process_tripwires.cpp
  src/host/supervisor.cpp
  src/host/variables.cpp
  src/recording/provenance.cpp
  src/replay/recorded_inputs.cpp
  src/replay/recorded_outputs.cpp
  src/recording/recorder.cpp
  src/recording/variable_recorder.cpp
  src/replay/altered_inputs.cpp
  src/scenario/branch_origin.cpp
  src/replay/copying_sink.cpp
  src/replay/recording_source.cpp
  src/replay/write_replay.cpp
  src/replay/recorded_words.cpp
  src/scenario/tick_span.cpp
  src/replay/replay.cpp
  src/replay/replay_comparison.cpp
  src/replay/replay_conditions.cpp
  src/scenario/trace_scenario.cpp
  src/run/hosted_commands.cpp
  src/run/recording_sink.cpp
  src/run/run.cpp)
target_include_directories(rehearse_harness PRIVATE ${XXHASH_INCLUDE_DIR})
target_compile_definitions(rehearse_harness PRIVATE REHEARSE_VERSION="${PROJECT_VERSION}")
# Replacements of C functions: each has a table of the functions behind it.
set_source_files_properties(src/host/file_tripwires.cpp src/host/process_tripwires.cpp PROPERTIES
  SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(src/recording/provenance.cpp PROPERTIES
  COMPILE_DEFINITIONS REHEARSE_OTHER_FLAGS="${REHEARSE_OTHER_FLAGS}")
target_link_libraries(rehearse_harness
  PUBLIC Rehearse::scenario Rehearse::trace
  PRIVATE Rehearse::cnoid Rehearse::png fmt::fmt Threads::Threads ${CMAKE_DL_LIBS})
# Functions are found when the library is loaded. Found at their first call, they would leave the processor's registers on
# the stack, right where a controller's uninitialised variables come to lie, and an audit paints that.
target_link_options(rehearse_harness PRIVATE -Wl,-z,now)
