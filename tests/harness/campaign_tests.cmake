rehearse_add_test(campaign_test LABEL unit
  SOURCES axis_test.cpp campaign_test.cpp campaign_figures_test.cpp campaign_run_test.cpp importance_test.cpp paired_cases_test.cpp plan_test.cpp
  LIBRARIES Rehearse::campaigns nlohmann_json::nlohmann_json)
target_compile_definitions(campaign_test PRIVATE AT_NIGHT=$<BOOL:${REHEARSE_NIGHTLY}>)
