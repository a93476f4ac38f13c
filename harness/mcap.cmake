# The container of recordings, reader and writer: nothing here knows what is in a message.
find_package(PkgConfig REQUIRED)
pkg_check_modules(MCAP_CODECS REQUIRED IMPORTED_TARGET libzstd liblz4 libdeflate)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)

rehearse_add_library(mcap
  src/mcap/by_summary.cpp
  src/mcap/chunks.cpp
  src/mcap/codec.cpp
  src/mcap/contents.cpp
  src/mcap/copy.cpp
  src/mcap/doctor.cpp
  src/mcap/doctor_chunks.cpp
  src/mcap/doctor_summary.cpp
  src/mcap/draft.cpp
  src/mcap/file_view.cpp
  src/trace/filter.cpp
  src/mcap/merge.cpp
  src/mcap/order.cpp
  src/mcap/output.cpp
  src/mcap/reader.cpp
  src/mcap/record_layout.cpp
  src/mcap/record_pass.cpp
  src/mcap/records.cpp
  src/mcap/recover.cpp
  src/mcap/resync.cpp
  src/trace/select.cpp
  src/mcap/sink.cpp
  src/mcap/stream.cpp
  src/mcap/summary.cpp
  src/mcap/survey.cpp
  src/mcap/writer.cpp)
target_include_directories(rehearse_mcap PUBLIC
  $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_compile_definitions(rehearse_mcap PRIVATE REHEARSE_VERSION="${PROJECT_VERSION}")
target_link_libraries(rehearse_mcap
  PUBLIC Rehearse::model
  PRIVATE PkgConfig::MCAP_CODECS fmt::fmt Threads::Threads)
