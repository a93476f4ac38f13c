// The rest of a message: all values without a column in its channel's table. These are strings, covariances, and a
// stamp that differs from the log time. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// The values of a message type that have a column in its channel's table, or name a column. TRACE_FORMAT.md lists the
/// columns of each type.
class ColumnFields {
 public:
  explicit ColumnFields(std::string_view type);
  bool covers(const ros2msg::Value& value) const;

 private:
  std::vector<std::string_view> patterns_;  // patterns of paths
  bool any_number_ = false;                 // for a type without specific columns: all numbers except header and stamp
};

/// Finds the rest of each message of a channel. It is nearly always equal to the rest of the message before, which is
/// detected by a comparison of bytes; only a different rest is decoded.
class MessageRest {
 public:
  /// Null if payloads of that encoding can't be decoded. In other encodings than CDR the rest is the whole payload.
  static std::unique_ptr<MessageRest> make(const std::string& type, std::string_view encoding,
                                           const mcap::Schema* schema);

  /// Reads a message; true if its rest differs from the rest of the message before, or if it is the first message.
  bool take(mcap::Bytes payload, std::uint64_t log_time);
  /// Treats the next message as the first.
  void forget() { bytes_.clear(); }

  /// The hash of the rest of the last message.
  std::uint64_t hash() const;
  /// A payload of the same schema with that rest, and with 0 in place of each value that has a column. Stamps that
  /// equal the log time are set to `log_time`.
  std::vector<std::byte> bytes_at(std::uint64_t log_time) const;

 private:
  struct Stamp {
    std::size_t seconds = 0, nanoseconds = 0;  // offsets in the payload
    bool is_log_time = false;
  };

  MessageRest(std::string_view type, ros2msg::Schema schema)
      : columns_(type), is_cdr_(schema.encoding == ros2msg::Encoding::cdr), decoder_(std::move(schema)) {}
  bool is_as_before(mcap::Bytes payload, std::uint64_t log_time) const;
  void decode(mcap::Bytes payload, std::uint64_t log_time);
  void find_kept(std::vector<std::pair<std::size_t, std::size_t>> cleared);

  ColumnFields columns_;
  const bool is_cdr_;
  ros2msg::Decoder decoder_;
  std::vector<std::byte> bytes_;  // the payload, with different bytes in place of values that don't belong to the rest
  std::vector<std::pair<std::size_t, std::size_t>> kept_;  // byte spans [first, second) of the rest
  std::vector<Stamp> stamps_;
};

}  // namespace rehearse
