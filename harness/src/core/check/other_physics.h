// Goldens whose world another physics engine or an earlier solver moved. Their inputs can be fed to the controllers,
// but a difference of the world says nothing about the scenario, the model or a sensor. Internal.
#pragma once

#include <rehearse/check.h>

#include <string>
#include <vector>

namespace rehearse {

/// The engines of two recordings of a scenario as the reason why their worlds are not compared, and the keys that
/// changed as well. Empty if both recordings state one engine, or if one of them states none. `changed_files`: as in
/// Comparison.
std::string other_physics(const Scenario& scenario, const Trace& golden, const Trace& fresh,
                          const std::vector<std::string>& changed_files);

/// The verdict on a check with CheckReport::other_physics. `replayed`: the result of level controller as a sentence;
/// may be empty.
Verdict verdict_on_physics(const CheckReport& evidence, const std::string& replayed);

}  // namespace rehearse
