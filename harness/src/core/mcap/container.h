// Logs in other containers than an MCAP file: rosbag2 folders, their SQLite databases, bags of ROS 1, files compressed
// by zstd. This room recognises them by their first bytes. Their reader converts them to an MCAP file, so that
// everything else reads MCAP alone. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/temporary_file.h"

namespace rehearse::mcap {

enum class Container { mcap, sqlite, zstd, ros1_bag, git_lfs_pointer, unknown };

/// The container of a file that begins with these bytes.
Container container_of(Bytes start);

/// A log as an MCAP file.
struct Converted {
  std::unique_ptr<TemporaryFile> file = std::make_unique<TemporaryFile>();
  std::string form;        // description of the container, as "rosbag2 database (SQLite, schema version 3)"
  std::uint64_t size = 0;  // size of the log's own files [bytes]
  Diagnostics damage;      // data that couldn't be converted
  std::optional<std::uint64_t> lost_messages = 0;  // number of messages that couldn't be converted; nullopt: unknown

  /// Adds damage by which so many messages are lost.
  void add_damage(const Diagnostics& found, std::optional<std::uint64_t> messages) {
    damage.insert(damage.end(), found.begin(), found.end());
    lost_messages = lost_messages && messages ? std::optional(*lost_messages + *messages) : std::nullopt;
  }
};
using ConvertedPtr = std::shared_ptr<const Converted>;

/// The folder of a log that is a folder, or the file metadata.yaml of one; empty: it is any other file.
std::filesystem::path folder_of(const std::filesystem::path& log);

/// A log that is a folder.
struct OpenedFolder {
  std::filesystem::path only_file;  // the MCAP file with all of its messages; empty: `converted` has them
  ConvertedPtr converted;
};

/// Reads logs in other containers.
class ContainerReader {
 public:
  virtual ~ContainerReader() = default;
  /// Converts a file in the container sqlite, zstd or ros1_bag. `bytes`: its content; `name`: its name in messages;
  /// `path` opens it.
  virtual Result<ConvertedPtr> convert_file(Container container, Bytes bytes, const std::string& name,
                                            const std::filesystem::path& path) const = 0;
  /// `name`: the folder's name in messages.
  virtual Result<OpenedFolder> open_folder(const std::filesystem::path& folder, const std::string& name) const = 0;
};

/// From now on FileView::open() opens other containers by `reader`, which must live as long as the process.
void set_container_reader(const ContainerReader& reader);
/// Null: this program reads only MCAP files.
const ContainerReader* container_reader();

}  // namespace rehearse::mcap
