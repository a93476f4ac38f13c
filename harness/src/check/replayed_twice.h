// Replays a recording twice, which shows whether its controllers repeat themselves.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace rehearse {

/// The first tick in which two replays of the recording have different outputs; none: they have equal bits in all
/// ticks. Fails if the recording can't be replayed.
Result<std::optional<std::int64_t>> first_unrepeated_tick(const std::filesystem::path& recording,
                                                          const HostOptions& host);

}  // namespace rehearse
