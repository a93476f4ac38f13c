// The commands that controllers write in initialize(), as metadata of a recording: "BODY/JOINT u": "0.5".
#pragma once

#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

/// The numbers of the command of the first step that differ from those of a command at rest; devices aside, whose
/// commands are messages of the recording.
mcap::StringMap metadata_of_initial_commands(const Scenario& scenario, const Command& command);

/// Writes them into a command at rest. What the scenario lacks, and what isn't a list of numbers, is left out.
void take_initial_commands(const mcap::StringMap& metadata, const Scenario& scenario, Command& command);

/// A number of these commands, in a recording and in another run of it. Of a pose that one of them lacks: NaN.
struct InitialNumber {
  std::string body;
  std::string element;  // "SHOULDER/u", "TIP/twist/2"
  double recorded, now;
};

/// The numbers that either of them states.
std::vector<InitialNumber> initial_numbers(const mcap::StringMap& recorded, const mcap::StringMap& now,
                                           const Scenario& scenario);

}  // namespace rehearse
