// Messages of any MCAP file as text, one line each: the output of `rehearse cat`.
//
// JSON: an object with topic, log_time, publish_time (both [ns]) and sequence, and either `message` or `data`.
// `message` is the decoded message (ros2msg schemas with cdr in the form of message_json.h; json as it is, without
// blanks). `data` is the bytes in base64, with `encoding` and `schema` (its name, or null). If a message should be
// decoded and can't be, `error` states the reason.
//
// For people: log time [s], topic, fields. Of pictures and other bytes only the number is shown.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// Prints the messages of one file.
class MessagePrinter {
 public:
  enum class Form { json, line };
  explicit MessagePrinter(Form form) : form_(form) {}

  /// One line with its newline, valid until the next call. `schema`: the schema of the message's channel; null if it
  /// has none.
  std::string_view print(const mcap::Message& message, const mcap::Schema* schema);

 private:
  /// The decoding of the messages of a channel.
  struct Decoding {
    std::optional<ros2msg::Decoder> decoder;
    bool is_json = false;
    std::string problem;  // reason why messages that should be decoded can't be decoded
  };
  Decoding& decoding_of(const mcap::Channel& channel, const mcap::Schema* schema);
  void print_json(const mcap::Message& message, const mcap::Schema* schema);
  void print_line(const mcap::Message& message, const mcap::Schema* schema);

  const Form form_;
  std::map<std::uint16_t, Decoding> decodings_;  // by channel
  std::string text_;
};

}  // namespace rehearse
