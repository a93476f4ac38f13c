// The page of a history for a browser: one file. Internal.
#pragma once

#include <filesystem>

#include "trends.h"

namespace rehearse {

/// Writes the page; replaces only a page of a history. Fails if the file can't be written.
Result<void> write_history_page(const Trends& trends, const std::filesystem::path& file);

}  // namespace rehearse
