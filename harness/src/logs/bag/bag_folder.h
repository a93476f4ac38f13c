// The folder of a rosbag2 recording: its metadata.yaml, which names the files with the messages, or these files alone.
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
  int line = 0;  // line in metadata.yaml
};

/// A number that metadata.yaml states.
struct StatedNumber {
  std::int64_t value = 0;
  int line = 0;  // line in metadata.yaml
};

/// The folder of a log that is a folder, or the file metadata.yaml of one; empty: it is any other file.
std::filesystem::path folder_of(const std::filesystem::path& log);

struct Folder {
  std::filesystem::path metadata;            // metadata.yaml; empty: the folder has none
  std::vector<std::filesystem::path> files;  // existing files, in the order of the recording
  std::string storage;                       // "mcap" or "sqlite3"
  bool compressed_messages = false;          // each message is compressed by zstd
  std::optional<StatedNumber> messages;      // number of messages in all files
  std::optional<StatedNumber> start;         // [ns]
  std::optional<StatedNumber> duration;      // [ns]
  std::vector<FolderTopic> topics;
};

/// Reads the folder's metadata.yaml. Fails, with the line, if it isn't a metadata.yaml of rosbag2 or names a missing
/// file, or if the storage or the compression is unknown. Without metadata.yaml the files are the folder's logs, in the
/// order of the numbers in their names; fails if there is none, or if they aren't the parts of one recording.
Result<Folder> read_folder(const std::filesystem::path& folder);

}  // namespace rehearse::bag
