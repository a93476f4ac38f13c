// The origin of a branch (BranchOrigin): its source by name and content, and the pushes added to it.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <string>

#include "core/trace/run_facts.h"

namespace rehearse {

/// "walk.mcap 0123456789abcdef". Fails if the file can't be read.
Result<std::string> name_and_hash(const std::filesystem::path& file);

/// "BODY/LINK force=X,Y,Z torque=X,Y,Z at=X,Y,Z @SPAN"; force or torque or both, world frame [N], [N·m]; `at` in the
/// link frame [m]. The span has the form of parse_span().
Result<Push> parse_push(const std::string& text, const Scenario& scenario);

}  // namespace rehearse
