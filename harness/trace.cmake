# Reading and writing recordings. No simulation, no controller: a replay, a viewer and a diff need this and no more.
find_package(PkgConfig REQUIRED)
pkg_check_modules(TRACE_CODECS REQUIRED IMPORTED_TARGET libzstd liblz4 libdeflate)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)

rehearse_add_library(trace
  src/trace/bytes.cpp
  src/trace/codec.cpp
  src/trace/file_view.cpp
  src/trace/mcap_copy.cpp
  src/trace/mcap_records.cpp
  src/trace/mcap_summary.cpp
  src/trace/mcap_writer.cpp
  src/trace/mcap_output.cpp
  src/trace/mcap_reader.cpp
  src/trace/mcap_scan.cpp
  src/trace/mcap_order.cpp
  src/trace/range_messages.cpp
  src/trace/ros2msg_parse.cpp
  src/trace/ros2msg_decode.cpp
  src/trace/trace_rows.cpp
  src/trace/trace_typed_rows.cpp
  src/trace/trace_load.cpp
  src/trace/trace.cpp)
target_include_directories(rehearse_trace PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_definitions(rehearse_trace PRIVATE REHEARSE_VERSION="${PROJECT_VERSION}")
target_link_libraries(rehearse_trace
  PUBLIC Rehearse::model
  PRIVATE PkgConfig::TRACE_CODECS fmt::fmt Threads::Threads)
