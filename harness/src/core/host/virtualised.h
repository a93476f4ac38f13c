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

/// A substitution with simulated time, and random numbers from a seed.
Substitution virtualised(std::uint64_t seed);

/// The changes to the environment of a process whose recordings must state that they are virtualised.
std::map<std::string, std::optional<std::string>> virtualised_environment(std::uint64_t seed);

/// "clock, random; seed 7" if this process's controllers get simulated time and random numbers; else empty. It is the
/// fact `virtualised` in a recording's provenance.
std::string virtualisation();

/// The seed of a virtualised recording; none: it isn't virtualised.
std::optional<std::uint64_t> virtualised_seed(const mcap::Reader& trace);

/// If the recording is virtualised, starts this program once more, with the same arguments, under the interposer, and
/// does not return. Returns if that isn't needed, or done already; fails if it can't be done.
Result<void> virtualise_process_like(const std::filesystem::path& trace);

}  // namespace rehearse
