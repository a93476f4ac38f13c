// The profiles that callgrind writes of a replay: one for each call of control(), with its instructions by line.
#pragma once

#include <rehearse/audit.h>
#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace rehearse {

/// The title of the profile of one call: "tick 12 of SR1/Walk".
std::string profile_title(const std::string& controller, std::int64_t tick);

/// Reads the profiles in a file of callgrind (its format: "Callgrind Format Specification" of valgrind's manual, with
/// positions that aren't compressed). `libraries`: the file of each controller's library by the controller's name.
/// Fails if the file can't be read or has another form.
Result<std::map<std::string, InstructionCounts>> read_instruction_profiles(
    const std::filesystem::path& file, const std::map<std::string, std::filesystem::path>& libraries);

/// 1204: "1,204"
std::string grouped(std::uint64_t number);

/// "control() of SR1/Walk takes 1204 instructions in the median tick, and at most ..., at tick 500: 96 % of them by
/// ..."
std::string instructions_sentence(const std::string& controller, const InstructionCounts& counts);

}  // namespace rehearse
