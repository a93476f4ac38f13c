// The folder of a rosbag2 recording: its metadata.yaml, which names the files with the messages.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::bag {

/// A topic as metadata.yaml states it.
struct FolderTopic {
  std::string name;
  std::string type;
  std::uint64_t messages = 0;
  int line = 0;  // in metadata.yaml
};

/// A number that metadata.yaml states.
struct StatedNumber {
  std::int64_t value = 0;
  int line = 0;  // in metadata.yaml
};

struct Folder {
  std::filesystem::path metadata;            // metadata.yaml
  std::vector<std::filesystem::path> files;  // in the order of the recording; all exist
  int version = 0;                           // of the form of metadata.yaml
  std::string storage;                       // "mcap" or "sqlite3"
  std::string distribution;                  // the ROS distribution that wrote it; empty: not stated
  bool compressed_messages = false;          // each message is compressed by zstd
  std::optional<StatedNumber> messages;      // of all files
  std::optional<StatedNumber> start;         // [ns]
  std::optional<StatedNumber> duration;      // [ns]
  std::vector<FolderTopic> topics;
};

/// Reads the folder's metadata.yaml. Fails, with the line, if it isn't one of rosbag2, names a missing file, or if the
/// storage or the compression is unknown.
Result<Folder> read_folder(const std::filesystem::path& folder);
/// The same for a text in memory, of the folder's metadata.yaml.
Result<Folder> parse_folder(const std::string& text, const std::filesystem::path& folder);

}  // namespace rehearse::bag
