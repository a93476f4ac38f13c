// The scenarios of the fixtures.
#pragma once

#include <rehearse/world.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "support/printed_by_name.h"

namespace rehearse {

/// The names of the scenarios, without .yaml, sorted.
inline std::vector<std::string> fixture_scenarios() {
  std::vector<std::string> names;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(FIXTURES_DIR "/scenarios"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// One scenario with one of the solvers.
struct FixtureCase {
  std::string name;  // of the scenario
  SolverSettings::Method solver;
};

inline std::string name_of(SolverSettings::Method solver) {
  return std::string(SolverSettings::method_names[static_cast<std::size_t>(solver)]);
}

/// Each scenario with each solver.
inline std::vector<FixtureCase> fixture_cases() {
  using Method = SolverSettings::Method;
  std::vector<FixtureCase> all;
  for (const std::string& scenario : fixture_scenarios())
    for (const Method solver : {Method::exact, Method::quick, Method::direct}) all.push_back({scenario, solver});
  return all;
}

}  // namespace rehearse
