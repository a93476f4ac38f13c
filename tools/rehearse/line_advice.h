// The command that finds the line by which a controller's commands differ from those of a golden.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::tool {

/// The first command that differs on the golden's inputs, beyond its tolerance if any is. None: all are equal, nothing
/// was fed, or a controller failed on these inputs.
std::optional<Divergence> first_differing_command(const CheckReport& report);

/// The words of "rehearse replay GOLDEN --beside COMMIT", with the commit in which the golden was accepted. Empty if
/// the commands of no controller differ, if that controller isn't in C++, if there is no gdb, or if git doesn't have
/// the golden as it is.
std::vector<std::string> words_beside(const Scenario& scenario, const CheckReport& report,
                                      const std::filesystem::path& golden, const HostOptions& host);

/// The words as a line for a terminal.
std::string line_of(const std::vector<std::string>& words);

/// " --controller NAME=LIB" for each library that the user named.
std::string words_of_libraries(const HostOptions& host);

/// The line of words_beside(). Empty in continuous integration, too, where a clone may have one commit.
std::string line_advice(const Scenario& scenario, const CheckReport& report, const std::filesystem::path& golden,
                        const HostOptions& host);

}  // namespace rehearse::tool
