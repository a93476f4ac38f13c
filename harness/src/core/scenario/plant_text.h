// The part of a scenario on which its world depends.
#pragma once

#include <rehearse/scenario.h>

#include <string>
#include <string_view>

namespace rehearse {

/// The text of the scenario file without the parts that only judge runs, and without libraries and options of
/// controllers. It has a line for each value. Two scenarios with equal texts and equal models have equal worlds, which
/// behave equally under equal commands.
Result<std::string> plant_text(const Scenario& scenario);

/// True for a key of the scenario that judges runs, and has no effect on one: expect, tolerances, golden, ...
bool only_judges(std::string_view key);

/// True if a shape of any body was read from a mesh file.
bool has_mesh_files(const Scenario& scenario);

/// True if the scenario has `simulate: always`: a check simulates the run even if it could prove the result.
bool always_simulates(const Scenario& scenario);

}  // namespace rehearse
