// The rest of a message: all that no column of its channel's table holds. Strings, covariances, a stamp that isn't the
// log time. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ros2msg.h"

namespace rehearse {

/// Which values of a message type have a column in its channel's table, or name one. TRACE_FORMAT.md lists the columns
/// of each type.
class HeldValues {
 public:
  explicit HeldValues(std::string_view type);
  bool holds(const ros2msg::Value& value) const;

 private:
  std::vector<std::string_view> patterns_;  // of paths
  bool any_number_ = false;                 // a type without columns of its own: all but header and stamp
};

/// Finds the rest of each message of a channel. Nearly always it is that of the message before, which is found by
/// comparing bytes; only another one is decoded.
class MessageRest {
 public:
  /// Null if the schema isn't ros2msg or can't be parsed.
  static std::unique_ptr<MessageRest> make(const std::string& type, const mcap::Schema* schema);

  /// Takes a message in; true if its rest differs from that of the message before, or there was none.
  bool take(mcap::Bytes payload, std::uint64_t log_time);
  /// The next message has none before it.
  void forget() { bytes_.clear(); }

  /// Of the message taken last.
  std::uint64_t hash() const;
  /// A payload of the same schema with that rest, and with 0 in place of each value that has a column. Stamps that are
  /// the log time are `log_time`.
  std::vector<std::byte> bytes_at(std::uint64_t log_time) const;

 private:
  struct Stamp {
    std::size_t seconds = 0, nanoseconds = 0;  // where they stand in the payload
    bool is_log_time = false;
  };

  MessageRest(std::string_view type, ros2msg::Schema schema) : held_(type), decoder_(std::move(schema)) {}
  bool is_as_before(mcap::Bytes payload, std::uint64_t log_time) const;
  void decode(mcap::Bytes payload, std::uint64_t log_time);
  void find_kept(std::vector<std::pair<std::size_t, std::size_t>> cleared);

  HeldValues held_;
  ros2msg::Decoder decoder_;
  std::vector<std::byte> bytes_;  // the payload, with other bytes for what isn't part of the rest
  std::vector<std::pair<std::size_t, std::size_t>> kept_;  // bytes [first, second) that are the rest
  std::vector<Stamp> stamps_;
};

}  // namespace rehearse
