find_package(nlohmann_json 3.10 REQUIRED)

rehearse_add_test(judging_test LABEL unit SHARDS 3
  SOURCES
    expectation_formula_test.cpp
    compare_test.cpp
    compare_events_test.cpp
    compare_fields_test.cpp
    compare_provenance_test.cpp
    compare_structure_test.cpp
    compare_time_test.cpp
    compare_windows_test.cpp
    divergence_test.cpp
    event_sequences_test.cpp
    expectation_test.cpp
    unknown_series_test.cpp
    verdict_code_test.cpp
    golden_acceptance_test.cpp
    golden_damage_test.cpp
    golden_list_test.cpp
    golden_test.cpp
    noise_floor_test.cpp
    picture_difference_test.cpp
    series_plot_test.cpp
    series_relations_test.cpp
    tick_clock_test.cpp
    tolerance_test.cpp
  LIBRARIES Rehearse::harness nlohmann_json::nlohmann_json)
