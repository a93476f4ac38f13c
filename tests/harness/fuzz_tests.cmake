# The search of fuzz tests, on controllers with a planted fault each.
include(RehearseControllers)

set(planted_controllers ${CMAKE_BINARY_DIR}/tests/planted)
rehearse_add_test(fuzz_search_test LABEL verdict TIMEOUT 300
  SOURCES fuzzing/fuzz_search_test.cpp fuzzing/fuzz_findings_test.cpp fuzzing/fuzz_verb_test.cpp
  LIBRARIES Rehearse::gtest Rehearse::fuzz nlohmann_json::nlohmann_json fmt::fmt)
target_include_directories(fuzz_search_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(fuzz_search_test PRIVATE
  PLANTED_CONTROLLERS="${planted_controllers}"
  PLANTED_MODEL="${CMAKE_CURRENT_SOURCE_DIR}/fuzzing/three_joints.urdf"
  REHEARSE_COMMAND="$<TARGET_FILE:rehearse>")
add_dependencies(fuzz_search_test rehearse)

# Planted has the compiler's calls, PlantedPlain hasn't.
rehearse_add_simple_controller(Planted fuzzing/planted.cpp FUZZ)
rehearse_add_simple_controller(PlantedPlain fuzzing/planted.cpp)
foreach(name Planted PlantedPlain)
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${planted_controllers})
  if(REHEARSE_SANITIZE)
    target_compile_options(${name} PRIVATE -fno-sanitize=all)  # what they do wrong is wanted
  endif()
  add_dependencies(fuzz_search_test ${name})
endforeach()
# A test that fails, for the tests of `rehearse fuzz`: ctest doesn't run it.
add_executable(planted_fuzz EXCLUDE_FROM_ALL fuzzing/planted_fuzz.cpp)
target_compile_features(planted_fuzz PRIVATE cxx_std_17)
target_compile_definitions(planted_fuzz PRIVATE
  PLANTED_CONTROLLERS="${planted_controllers}"
  PLANTED_MODEL="${CMAKE_CURRENT_SOURCE_DIR}/fuzzing/three_joints.urdf")
target_link_libraries(planted_fuzz PRIVATE rehearse_flags Rehearse::gtest Rehearse::fuzz)
add_dependencies(planted_fuzz Planted)
target_compile_definitions(fuzz_search_test PRIVATE PLANTED_FUZZ="$<TARGET_FILE:planted_fuzz>")
add_dependencies(fuzz_search_test planted_fuzz rehearse-fuzz)

# Five faults by day, each with one seed; at night all of them, with ten.
set(planted_night 0)
set(planted_seeds 1)
set(planted_runs 2000)
set(sound_runs 96)
if(REHEARSE_NIGHTLY AND NOT REHEARSE_SANITIZE)
  set(planted_night 1)
  set(planted_seeds 10)
  set(planted_runs 20000)
  set(sound_runs 5000)
endif()
target_compile_definitions(fuzz_search_test PRIVATE
  PLANTED_NIGHT=${planted_night} PLANTED_SEEDS=${planted_seeds} PLANTED_RUNS=${planted_runs} SOUND_RUNS=${sound_runs})
