# The conformance suite of the MCAP project: cmake -DREHEARSE_MCAP_CONFORMANCE=DIR, where DIR is the folder
# tests/conformance/data of a checkout of it. It is not part of this repository, so without it the tests are skipped.
set(REHEARSE_MCAP_CONFORMANCE "" CACHE PATH "Folder tests/conformance/data of the MCAP project")
find_package(nlohmann_json 3.11 REQUIRED)

rehearse_add_test(mcap_conformance_test LABEL compat
  SOURCES mcap/conformance_test.cpp
  LIBRARIES Rehearse::harness nlohmann_json::nlohmann_json)
target_compile_definitions(mcap_conformance_test PRIVATE MCAP_CONFORMANCE_DIR="${REHEARSE_MCAP_CONFORMANCE}")
