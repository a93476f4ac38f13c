rehearse_add_test(log_test LABEL unit
  SOURCES
    log/map_broken_test.cpp
    log/map_test.cpp
  LIBRARIES Rehearse::log)
target_include_directories(log_test PRIVATE ${PROJECT_SOURCE_DIR}/harness/src)
