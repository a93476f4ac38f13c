// Logs in other containers than an MCAP file: rosbag2 folders, their SQLite databases, files compressed by zstd. They
// are converted to an MCAP file in the folder for temporary files, so that everything else reads MCAP alone. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <memory>
#include <string>

#include "bag/bag_folder.h"
#include "temporary_file.h"

namespace rehearse::mcap {

enum class Container { mcap, sqlite, zstd, ros1_bag, unknown };

/// The container of a file that begins with these bytes.
Container container_of(Bytes start);

/// A log as an MCAP file.
struct Converted {
  std::unique_ptr<TemporaryFile> file = std::make_unique<TemporaryFile>();
  std::string form;        // description of the container, as "rosbag2 database (SQLite, schema version 3)"
  std::uint64_t size = 0;  // size of the log's own files [bytes]
  Diagnostics damage;      // data that couldn't be converted
};
using ConvertedPtr = std::shared_ptr<const Converted>;

/// Converts a database or a compressed file. The last eight results are kept: a log that hasn't changed isn't converted
/// twice. `bytes`: the file's content; `name`: its name in messages; `path` opens it. Messages have the order in which
/// they were recorded, and their bytes. Topics of a type that the log doesn't define get the definition of the standard
/// packages; without one their schema has a name alone.
Result<ConvertedPtr> convert_file(Container container, Bytes bytes, const std::string& name,
                                  const std::filesystem::path& path);

/// Converts all files of a folder to one file, in the same way.
Result<ConvertedPtr> convert_folder(const bag::Folder& folder, const std::string& name);

}  // namespace rehearse::mcap
