// The doctor's checks of a rosbag2 folder and of its databases, in addition to the checks of MCAP files.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <optional>

#include "bag_folder.h"

namespace rehearse {

/// Compares metadata.yaml with the messages of the folder's files. Errors: other numbers of messages, a topic that is
/// missing on one side, another type. Warnings: another start or duration. Each finding has its line. Reads all
/// messages.
Diagnostics examine_metadata(const bag::Folder& folder, const std::filesystem::path& path);

/// The findings of a file's own container: SQLite's check of a database, and its topics with another serialization than
/// CDR. nullopt: the file is MCAP.
std::optional<Diagnostics> examine_container(const std::filesystem::path& file);

}  // namespace rehearse
