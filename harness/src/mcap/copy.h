// Copying a recording and adding to what is said about it. The messages stay as they are, byte for byte.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// Writes `target` as a copy of the file `source` whose data section ends with these metadata records. The records that
/// end it already and whose names begin with `replaced` are left out; all others keep their bytes and their places.
/// DataEnd, summary and Footer are composed anew, with their CRCs. Fails if the source isn't whole or has no summary;
/// a target that was begun stays.
Result<void> copy_with_metadata(const std::filesystem::path& source, const std::filesystem::path& target,
                                std::string_view replaced, const std::vector<Metadata>& added);

}  // namespace rehearse::mcap
