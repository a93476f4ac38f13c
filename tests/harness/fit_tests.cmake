# Fits to recordings of simulated robots whose numbers are known.
rehearse_add_test(fit_test LABEL verdict TIMEOUT 300
  SOURCES fitting/fit_test.cpp fitting/fit_undecided_test.cpp fitting/fit_verb_test.cpp
  LIBRARIES Rehearse::fitting Rehearse::simulation Rehearse::harness nlohmann_json::nlohmann_json fmt::fmt)
target_include_directories(fit_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(fit_test PRIVATE TEST_CONTROLLERS="${test_controllers}" AT_NIGHT=$<BOOL:${REHEARSE_NIGHTLY}>
  REHEARSE_COMMAND="$<TARGET_FILE:rehearse>")
add_test_controller(Shaker controllers/Shaker.cpp)
add_dependencies(fit_test Shaker rehearse rehearse-fitting)
