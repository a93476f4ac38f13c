# Rehearse::gtest: what tests of controllers link. The library does the work, GoogleTest is in the header and in main().
find_package(GTest 1.12 REQUIRED)

rehearse_add_library(testing src/testing/controller_bench.cpp src/testing/golden_assertions.cpp src/testing/gtest_support.cpp
  src/testing/test_folders.cpp src/testing/test_reports.cpp)
target_link_libraries(rehearse_testing
  PUBLIC Rehearse::harness
  PRIVATE Rehearse::simulation Rehearse::report Rehearse::cnoid nlohmann_json::nlohmann_json fmt::fmt)

add_library(rehearse_gtest STATIC src/testing/gtest_main.cpp)
add_library(Rehearse::gtest ALIAS rehearse_gtest)
set_target_properties(rehearse_gtest PROPERTIES EXPORT_NAME gtest)
target_link_libraries(rehearse_gtest
  PUBLIC Rehearse::testing GTest::gtest
  PRIVATE $<BUILD_INTERFACE:rehearse_flags>)
