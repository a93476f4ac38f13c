# Comparing runs, and the golden ones' life. Part of the harness library: it replays controllers, but simulates nothing.
find_package(nlohmann_json 3.10 REQUIRED)

target_sources(rehearse_harness PRIVATE
  src/golden/acceptance.cpp
  src/check/blame.cpp
  src/check/check.cpp
  src/check/check_golden.cpp
  src/check/check_json.cpp
  src/compare/compare.cpp
  src/compare/compare_channel.cpp
  src/compare/compare_envelope.cpp
  src/compare/compare_events.cpp
  src/compare/compare_fields.cpp
  src/compare/compare_json.cpp
  src/compare/compare_numbers.cpp
  src/compare/compare_pictures.cpp
  src/compare/compare_provenance.cpp
  src/compare/compare_report.cpp
  src/compare/compare_structure.cpp
  src/compare/compare_variables.cpp
  src/compare/digest.cpp
  src/compare/event_sequences.cpp
  src/compare/expectation.cpp
  src/golden/golden.cpp
  src/golden/golden_accept.cpp
  src/golden/golden_files.cpp
  src/golden/run_folder.cpp
  src/golden/golden_owners.cpp
  src/golden/golden_list.cpp
  src/golden/golden_partial.cpp
  src/check/noise_file.cpp
  src/check/noise_floor.cpp
  src/check/noise_measurement.cpp
  src/golden/partial_candidate.cpp
  src/golden/pending_verdict.cpp
  src/check/perturbed_run.cpp
  src/compare/picture_difference.cpp
  src/check/plant_level.cpp
  src/compare/recorded_picture.cpp
  src/compare/run_survey.cpp
  src/check/replayed_twice.cpp
  src/check/reproduction.cpp
  src/check/scenario_changes.cpp
  src/compare/series_plot.cpp)
find_package(yaml-cpp 0.7 REQUIRED)
target_link_libraries(rehearse_harness PRIVATE nlohmann_json::nlohmann_json yaml-cpp)
