// Runs whose controllers get simulated time and seeded random numbers instead of the system's.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "interposer.h"

namespace rehearse {

/// Simulated time, and random numbers from a seed.
Substitution virtualised(std::uint64_t seed);

/// What changes in the environment of a process whose recordings are to say that they were made so.
std::map<std::string, std::optional<std::string>> virtualised_environment(std::uint64_t seed);

/// "clock, random; seed 7", if this process's controllers are given that; else empty. Stands in a recording's
/// provenance as `virtualised`.
std::string virtualisation();

/// The seed of a recording that was made so; none: it wasn't.
std::optional<std::uint64_t> virtualised_seed(const mcap::Reader& trace);

/// If the recording was made so, starts this program once more, with the same arguments, under the interposer, and does
/// not come back. Comes back if that isn't needed, or done already; fails if it can't be done.
Result<void> virtualise_process_like(const std::filesystem::path& trace);

}  // namespace rehearse
