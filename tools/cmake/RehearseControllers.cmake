# rehearse_add_simple_controller(NAME sources... [COVERAGE] [FUZZ]): a controller's library, NAME.so, to be named in a scenario.
#
# The library is a module without a prefix, C++17, and links Rehearse::cnoid only. Its folder is the one in which the
# harness searches controllers of the build: lib/rehearse/controllers in the build folder. Add other libraries with
# target_link_libraries(NAME PRIVATE ...). choreonoid_add_simple_controller is a synonym, so that a CMakeLists.txt
# written for Choreonoid needs no change. With COVERAGE it is compiled with -g -O0 whatever the build type, so that each
# line and each branch has code of its own, which `rehearse check --coverage` watches. With FUZZ the compiler adds calls
# to its branches and comparisons, by which fuzz tests (<rehearse/fuzz.h>) are guided; its commands stay the same.

include(${CMAKE_CURRENT_LIST_DIR}/RehearseBits.cmake)

function(rehearse_add_simple_controller name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "COVERAGE;FUZZ" "" "")
  if(NOT arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "rehearse_add_simple_controller(${name}): name at least one source file")
  endif()
  add_library(${name} MODULE ${arg_UNPARSED_ARGUMENTS})
  set_target_properties(${name} PROPERTIES
    PREFIX ""
    CXX_STANDARD 17
    CXX_STANDARD_REQUIRED ON
    CXX_EXTENSIONS OFF
    CXX_VISIBILITY_PRESET hidden  # the factory and the API's classes are visible whatever this says
    VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/rehearse/controllers)
  # A fused multiply-add rounds once where two instructions round twice: commands would differ between CPUs.
  target_compile_options(${name} PRIVATE -ffp-contract=off)
  # control() that ends in a call of another library keeps its frame, by which an audit attributes the call.
  target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:C>:-fno-optimize-sibling-calls>)
  if(arg_COVERAGE)  # behind the options of the build type, which they override
    target_compile_options(${name} PRIVATE -g -O0)
  endif()
  if(arg_FUZZ)
    rehearse_add_fuzz_points(${name})
  endif()
  target_link_libraries(${name} PRIVATE Rehearse::cnoid)
  rehearse_warn_of_other_flags(${name})
endfunction()

# The callbacks of the instrumentation are in the library itself, so that every program can load it.
set(REHEARSE_FUZZ_POINTS ${CMAKE_CURRENT_LIST_DIR}/fuzz_points.cpp)
function(rehearse_add_fuzz_points name)
  set(points trace-pc)  # of gcc: by address, and comparisons of floating-point numbers as well
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    set(points trace-pc-guard)
  endif()
  target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:C,CXX>:-fsanitize-coverage=${points},trace-cmp>)
  target_sources(${name} PRIVATE ${REHEARSE_FUZZ_POINTS})
  set_source_files_properties(${REHEARSE_FUZZ_POINTS} PROPERTIES
    COMPILE_OPTIONS -fno-sanitize-coverage=${points},trace-cmp SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(choreonoid_add_simple_controller name)
  rehearse_add_simple_controller(${name} ${ARGN})
endfunction()

# rehearse_add_rust_controller(NAME MANIFEST): the library of a crate of the type cdylib, as NAME.so in the same folder.
#
# cargo builds it, in its profile release and without a network. MANIFEST is the crate's Cargo.toml.
function(rehearse_add_rust_controller name manifest)
  find_program(REHEARSE_CARGO cargo)
  if(NOT REHEARSE_CARGO)
    message(FATAL_ERROR "rehearse_add_rust_controller(${name}): cargo isn't installed; on Debian: apt install cargo")
  endif()
  get_filename_component(manifest ${manifest} ABSOLUTE)
  file(STRINGS ${manifest} names REGEX "^name *= *\"[^\"]+\"")
  if(NOT names)
    message(FATAL_ERROR "rehearse_add_rust_controller(${name}): ${manifest} has no line: name = \"...\"")
  endif()
  list(GET names -1 crate)  # that of [lib], if there is one
  string(REGEX REPLACE "^name *= *\"([^\"]+)\".*" "\\1" crate "${crate}")
  string(REPLACE - _ crate ${crate})
  set(target_folder ${CMAKE_BINARY_DIR}/cargo/${name})
  add_custom_target(${name} ALL
    COMMAND ${REHEARSE_CARGO} build --release --offline --quiet --manifest-path ${manifest} --target-dir ${target_folder}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/lib/rehearse/controllers
    COMMAND ${CMAKE_COMMAND} -E copy_if_different ${target_folder}/release/lib${crate}.so
      ${CMAKE_BINARY_DIR}/lib/rehearse/controllers/${name}.so
    VERBATIM)
endfunction()

# rehearse_tell_old_libraries(TEST_PROGRAM CONTROLLERS...): a file for ctest, whose message() it prints before the tests.
function(rehearse_tell_old_libraries name)
  set(libraries "")
  foreach(controller ${ARGN})
    set(library ${CMAKE_BINARY_DIR}/lib/rehearse/controllers/${controller}.so)
    get_target_property(type ${controller} TYPE)
    if(type MATCHES "MODULE_LIBRARY|SHARED_LIBRARY")
      set(library $<TARGET_FILE:${controller}>)
    endif()
    string(APPEND libraries " \"${library}\"")
  endforeach()
  set(notes ${CMAKE_CURRENT_BINARY_DIR}/${name}_notes.cmake)
  file(GENERATE OUTPUT ${notes} CONTENT
"set(folder \"\$ENV{PWD}\")
if(NOT IS_DIRECTORY \"\${folder}\")
  set(folder \"${CMAKE_SOURCE_DIR}\")
endif()
execute_process(COMMAND \"$<TARGET_FILE:${name}>\" --gtest_list_tests --rehearse_notes_on${libraries}
  WORKING_DIRECTORY \"\${folder}\" OUTPUT_QUIET ERROR_VARIABLE notes ERROR_STRIP_TRAILING_WHITESPACE TIMEOUT 20)
if(notes MATCHES \"^note: \")
  message(\"\${notes}\")
endif()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${notes})
endfunction()

# rehearse_add_controller_test(NAME SOURCES files... [CONTROLLERS targets...] [FIXTURES folder] [GOLDEN folder]
#                              [LABEL label] [TIMEOUT seconds]): a test program written with <rehearse/gtest.h>.
#
# Each TEST is one ctest. Scenarios and models are named relative to FIXTURES (default: fixtures), goldens are in GOLDEN
# (default: golden); both folders are relative to the current CMakeLists.txt. The controllers are built before the test.
# Recordings go to traces/ of the build folder, and those that differ from their golden to goldens/pending/. ctest prints
# at its start which of the controllers were built before the last change of their sources: the output of tests that pass
# isn't shown.
function(rehearse_add_controller_test name)
  cmake_parse_arguments(arg "" "FIXTURES;GOLDEN;LABEL;TIMEOUT" "SOURCES;CONTROLLERS" ${ARGN})
  if(NOT arg_SOURCES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "rehearse_add_controller_test(${name}): SOURCES are missing, or these words mean nothing "
                        "here: '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  foreach(word ${arg_SOURCES} ${arg_CONTROLLERS})
    if(word MATCHES "^[A-Z]+$" AND NOT TARGET ${word})
      message(FATAL_ERROR "rehearse_add_controller_test(${name}): '${word}' is neither a keyword nor a target: expected "
                          "SOURCES, CONTROLLERS, FIXTURES, GOLDEN, LABEL or TIMEOUT")
    endif()
  endforeach()
  if(arg_FIXTURES AND NOT IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/${arg_FIXTURES} AND NOT IS_DIRECTORY "${arg_FIXTURES}")
    message(FATAL_ERROR "rehearse_add_controller_test(${name}): FIXTURES: there is no folder '${arg_FIXTURES}' in "
                        "${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  foreach(default "FIXTURES=fixtures" "GOLDEN=golden" "LABEL=golden" "TIMEOUT=300")
    string(REGEX MATCH "^([A-Z]+)=(.*)$" matched ${default})
    if(NOT arg_${CMAKE_MATCH_1})
      set(arg_${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
    endif()
  endforeach()
  get_filename_component(fixtures ${arg_FIXTURES} ABSOLUTE)
  get_filename_component(golden ${arg_GOLDEN} ABSOLUTE)
  add_executable(${name} ${arg_SOURCES})
  target_compile_definitions(${name} PRIVATE
    REHEARSE_TEST_FIXTURES="${fixtures}"
    REHEARSE_TEST_GOLDEN="${golden}"
    REHEARSE_TEST_OUTPUT="${CMAKE_BINARY_DIR}"
    REHEARSE_TEST_CONTROLLERS="${CMAKE_BINARY_DIR}/lib/rehearse/controllers")
  target_link_libraries(${name} PRIVATE Rehearse::gtest $<$<TARGET_EXISTS:Rehearse::fuzz>:Rehearse::fuzz>)
  if(arg_CONTROLLERS)
    add_dependencies(${name} ${arg_CONTROLLERS})
  endif()
  get_property(is_multi GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(arg_CONTROLLERS AND NOT is_multi)
    rehearse_tell_old_libraries(${name} ${arg_CONTROLLERS})
  endif()
  include(GoogleTest)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT})
endfunction()
