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
  std::ranges::sort(names);
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

/// Each scenario with the direct solver, and with both of ODE's each at night, by day one third with each. Robots with
/// joints that follow others are refused by ODE's.
inline std::vector<FixtureCase> fixture_cases() {
  using Method = SolverSettings::Method;
  std::vector<FixtureCase> all;
  const std::vector<std::string> scenarios = fixture_scenarios();
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    constexpr std::size_t one_in = AT_NIGHT ? 1 : 3;
    all.push_back({scenarios[i], Method::direct});
    if (scenarios[i] == "playback" || scenarios[i] == "mesh_arm") continue;
    if (i % one_in == 0) all.push_back({scenarios[i], Method::quick});
    if ((i + 1) % one_in == 0) all.push_back({scenarios[i], Method::exact});
  }
  return all;
}

}  // namespace rehearse
