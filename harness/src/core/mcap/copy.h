// Copies a recording and changes its metadata records. The messages are copied byte for byte.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// Writes `target` as a copy of the file `source` whose data section ends with the metadata records `added`. Metadata
/// records at its present end whose names begin with `replaced` are left out. All other records keep their bytes and
/// their offsets. DataEnd, summary and Footer are composed again, with their CRCs. Fails if the source isn't whole or
/// has no summary; an incomplete target stays.
Result<void> copy_with_metadata(const std::filesystem::path& source, const std::filesystem::path& target,
                                std::string_view replaced, const std::vector<Metadata>& added);

}  // namespace rehearse::mcap
