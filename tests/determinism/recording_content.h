// The content that must be equal in two recordings with the same bits: each message of each channel, including pictures
// and hashes of states, the attachments and the outcome. Provenance and compression are not part of it. The costs of
// control() stand beside it, because only some rows count them.
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
  std::uint64_t hash = 0;  // of the message's bytes, number and times
  bool operator==(const MessageContent&) const = default;
};

struct ChannelContent {
  std::string topic;
  std::uint64_t definition = 0;  // hash of its schema, encoding and metadata
  std::vector<MessageContent> messages;
};

struct RecordingContent {
  std::vector<ChannelContent> channels;              // in the order of their definition
  std::map<std::string, std::uint64_t> attachments;  // hashes of their contents
  std::uint64_t outcome = 0;                         // hash of the outcome; 0 for the first part of a run
  std::vector<ChannelContent> costs;                 // of control(), a channel of each controller; not in the hash

  std::uint64_t hash() const;
};

/// The content of a whole recording, or of its messages before a time [ns]; fails if the file isn't complete.
Result<RecordingContent> content_of(const std::filesystem::path& recording,
                                    std::optional<std::uint64_t> before = std::nullopt);

/// The first difference between two recordings, as "tick 12 (0.012 s), /SR1/joints"; empty: none. `time_step` [s].
std::string first_difference(const RecordingContent& expected, const RecordingContent& actual, double time_step);

/// The same of some of their channels.
std::string first_difference(const std::vector<ChannelContent>& expected, const std::vector<ChannelContent>& actual,
                             double time_step);

/// Hash of all the bytes of a file.
Result<std::uint64_t> hash_of_file(const std::filesystem::path& file);

}  // namespace rehearse::matrix
