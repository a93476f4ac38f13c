// Replays a recording twice: whether controllers repeat themselves is seen, not guessed.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace rehearse {

/// The first tick in which two replays of the recording give other outputs; none: they give the same bits in all ticks.
/// Fails if the recording can't be replayed.
Result<std::optional<std::int64_t>> first_unrepeated_tick(const std::filesystem::path& recording,
                                                          const HostOptions& host);

}  // namespace rehearse
