# Comparing runs, and the golden ones' life. Part of the harness library: it replays controllers, but simulates nothing.
find_package(nlohmann_json 3.10 REQUIRED)

target_sources(rehearse_harness PRIVATE
  src/acceptance.cpp
  src/blame.cpp
  src/check.cpp
  src/compare.cpp
  src/compare_envelope.cpp
  src/compare_events.cpp
  src/compare_json.cpp
  src/compare_numbers.cpp
  src/compare_pictures.cpp
  src/compare_provenance.cpp
  src/compare_report.cpp
  src/compare_structure.cpp
  src/digest.cpp
  src/event_sequences.cpp
  src/expectation.cpp
  src/golden.cpp
  src/golden_accept.cpp
  src/golden_files.cpp
  src/golden_list.cpp
  src/golden_partial.cpp
  src/noise_file.cpp
  src/noise_floor.cpp
  src/noise_measurement.cpp
  src/partial_candidate.cpp
  src/perturbed_run.cpp
  src/picture_difference.cpp
  src/plant_level.cpp
  src/recorded_picture.cpp
  src/reproduction.cpp
  src/series_plot.cpp)
find_package(yaml-cpp 0.7 REQUIRED)
target_link_libraries(rehearse_harness PRIVATE nlohmann_json::nlohmann_json yaml-cpp)
