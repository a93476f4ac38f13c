// The first change of a scenario's structure: its bodies, its controllers, and how these take part.
#pragma once

#include <string>

namespace rehearse {

/// Compares the text of a scenario with an earlier one. "line 12: delay of controller 'Arm/Hold' is false, and was
/// true"; bodies and controllers that are new, renamed or gone are found likewise. The order of bodies doesn't count.
/// Empty: the structure is the same, or one of the texts is no YAML.
std::string structure_change(const std::string& before, const std::string& now);

}  // namespace rehearse
