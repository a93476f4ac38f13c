// Messages of any MCAP file as text, one line each: what `rehearse cat` prints.
//
// JSON: an object with topic, log_time, publish_time (both [ns]) and sequence, and either `message`: what was decoded
// (ros2msg schemas with cdr, as message_json.h has it; json as it is, without blanks), or `data`: the bytes in base64,
// with `encoding` and `schema` (its name, or null). If it should have been decoded and couldn't be, `error` says why.
//
// For people: log time [s], topic, fields. Pictures and other bytes show their number.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "ros2msg.h"

namespace rehearse {

/// Prints the messages of one file.
class MessagePrinter {
 public:
  enum class Form { json, line };
  explicit MessagePrinter(Form form) : form_(form) {}

  /// One line with its newline, valid until the next call. `schema`: of the message's channel, null if it has none.
  std::string_view print(const mcap::Message& message, const mcap::Schema* schema);

 private:
  /// How messages of a channel are decoded.
  struct Decoding {
    std::optional<ros2msg::Decoder> decoder;
    bool is_json = false;
    std::string problem;  // why they aren't, if they should
  };
  Decoding& decoding_of(const mcap::Channel& channel, const mcap::Schema* schema);
  void print_json(const mcap::Message& message, const mcap::Schema* schema);
  void print_line(const mcap::Message& message, const mcap::Schema* schema);

  const Form form_;
  std::map<std::uint16_t, Decoding> decodings_;  // by channel
  std::string text_;
};

}  // namespace rehearse
