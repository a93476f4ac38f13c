# Watching controllers: what they call, what their libraries hold. A library of its own, so that a replay links neither a
# disassembler nor a reader of debug information.
find_package(PkgConfig REQUIRED)
pkg_check_modules(AUDIT REQUIRED IMPORTED_TARGET libdw libelf capstone)

add_subdirectory(interposer)

rehearse_add_library(audit
  src/audit/call_log.cpp
  src/audit/interposer.cpp
  src/audit/library_scan.cpp)
target_include_directories(rehearse_audit PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(rehearse_audit
  PUBLIC Rehearse::harness
  PRIVATE PkgConfig::AUDIT fmt::fmt ${CMAKE_DL_LIBS})
add_dependencies(rehearse_audit rehearse_interposer)
