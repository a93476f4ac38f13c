# The interposer. The watched libraries are not controllers: these tests need no harness.
set(audit_libraries ${CMAKE_BINARY_DIR}/tests/audit_libraries)
function(add_watched_library name)
  add_library(${name} SHARED ${ARGN})
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_compile_options(${name} PRIVATE -O1 -g -fno-sanitize=all)
  target_link_options(${name} PRIVATE -fno-sanitize=all)
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${audit_libraries})
endfunction()
add_watched_library(brought_along audit/libraries/brought_along.cpp)
add_watched_library(watched_plugin audit/libraries/plugin.cpp)
set_target_properties(watched_plugin PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${audit_libraries}/plugins)
add_watched_library(watched audit/libraries/watched.cpp)
target_link_libraries(watched PRIVATE brought_along Threads::Threads ${CMAKE_DL_LIBS})
target_link_options(watched PRIVATE "LINKER:-rpath,${audit_libraries}/plugins")
# clang writes no index of addresses into a library.
set(unindexed ${audit_libraries}/libunindexed.so)
add_custom_command(OUTPUT ${unindexed} DEPENDS watched
  COMMAND ${CMAKE_OBJCOPY} --remove-section=.debug_aranges $<TARGET_FILE:watched> ${unindexed} VERBATIM)
add_custom_target(unindexed DEPENDS ${unindexed})

add_watched_library(instructions audit/libraries/instructions.cpp)
add_watched_library(startup audit/libraries/startup.cpp)
add_watched_library(starts_early audit/libraries/starts_early.cpp)
add_watched_library(fast_math audit/libraries/plugin.cpp)
target_link_options(fast_math PRIVATE -ffast-math)

add_executable(watched_process audit/watched_process.cpp)
target_link_libraries(watched_process PRIVATE rehearse_flags rehearse_private_headers Rehearse::audit ${CMAKE_DL_LIBS})

rehearse_add_test(audit_tests LABEL unit
  SOURCES audit/interposer_test.cpp audit/library_scan_test.cpp audit/stack_fill_test.cpp
          audit/substitution_test.cpp
  LIBRARIES Rehearse::audit)
target_compile_definitions(audit_tests PRIVATE
  AUDIT_LIBRARIES="${audit_libraries}" WATCHED_PROCESS="$<TARGET_FILE:watched_process>")
add_dependencies(audit_tests unindexed watched_plugin instructions starts_early startup fast_math watched_process rehearse_interposer)
