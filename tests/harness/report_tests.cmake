find_package(nlohmann_json 3.10 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate)

rehearse_add_test(report_test LABEL unit SHARDS 2
  SOURCES
    report/report_robots_test.cpp
    report/long_report_test.cpp
    report/report_test.cpp
  LIBRARIES Rehearse::viewing Rehearse::simulation Rehearse::harness nlohmann_json::nlohmann_json PkgConfig::LIBDEFLATE)
rehearse_add_test(history_test LABEL unit
  SOURCES history/chance_of_fall_test.cpp history/history_test.cpp history/trends_test.cpp
  LIBRARIES Rehearse::viewing nlohmann_json::nlohmann_json)
target_compile_definitions(history_test PRIVATE HISTORIES=$<IF:$<BOOL:${REHEARSE_NIGHTLY}>,400,100>)
