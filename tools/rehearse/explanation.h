// check --explain: where to look after a check that failed, and the next commands.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <string>
#include <vector>

#include "output.h"

namespace rehearse::tool {

struct Explanation {
  Diagnostics places;             // notes with file and line, the likeliest cause first
  std::vector<std::string> next;  // commands
};

/// 1. The line at which a controller failed. 2. The changed keys of scenario and models. 3. The line of the controller
/// that writes the first differing command, which gdb finds in seconds. 4. The violated expectations. `golden`: empty
/// if there is none.
Explanation explain(const Scenario& scenario, const CheckReport& report, const std::filesystem::path& golden,
                    const HostOptions& host);

Json json_of(const Explanation& explanation);

/// Prints a line for each place and each command.
void tell(const Explanation& explanation);

}  // namespace rehearse::tool
