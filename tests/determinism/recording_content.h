// What two recordings have to have in common to be the same bits: each message of each channel, pictures and hashes of
// states among them, the attachments and the outcome; not what they were made with and how they are packed.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::matrix {

struct MessageContent {
  std::uint64_t time = 0;  // log time [ns]
  std::uint64_t hash = 0;  // of its bytes, its number and its times
  bool operator==(const MessageContent&) const = default;
};

struct ChannelContent {
  std::string topic;
  std::uint64_t definition = 0;  // hash of its schema, encoding and metadata
  std::vector<MessageContent> messages;
};

struct RecordingContent {
  std::vector<ChannelContent> channels;              // as they were defined
  std::map<std::string, std::uint64_t> attachments;  // hashes of what is in them
  std::uint64_t outcome = 0;                         // hash of it; 0 of the first part of a run

  std::uint64_t hash() const;
};

/// Of a whole recording, or of its messages before a time [ns]; fails if the file isn't whole.
Result<RecordingContent> content_of(const std::filesystem::path& recording,
                                    std::optional<std::uint64_t> before = std::nullopt);

/// Where the second one first isn't the first, as "tick 12 (0.012 s), /SR1/joints"; empty: nowhere. `time_step` [s].
std::string first_difference(const RecordingContent& expected, const RecordingContent& actual, double time_step);

/// Hash of all the bytes of a file.
Result<std::uint64_t> hash_of_file(const std::filesystem::path& file);

}  // namespace rehearse::matrix
