// Comparison of messages field by field. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "channel_findings.h"
#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// A value of a message whose bytes outlive it.
struct MessageField {
  std::string path;
  ros2msg::Value value;  // without its path
};

/// Judges the values of messages that have no column: numbers by tolerance, all others exactly. Reports each value that
/// differs.
class FieldJudge {
 public:
  FieldJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings);
  ~FieldJudge();

  /// The messages of the following calls are in this window.
  void begin(const MatchedChannel& window) { window_ = &window; }
  /// Compares two messages except the field `left_out`. True if a value differs; false also if the schema is unknown.
  bool compare(std::size_t golden_message, mcap::Bytes expected, mcap::Bytes actual, std::string_view left_out = {});
  bool knows_values() const { return decoders_ != nullptr; }
  /// Reports a message whose bytes differ although its values are equal: nothing fails, but the messages aren't equal.
  void report_encoding(std::size_t golden_message);
  /// Reports a message whose bytes differ and whose values are unknown.
  void report_bytes(std::size_t golden_message);

 private:
  struct Decoders;
  using Fields = std::vector<MessageField>;

  void compare_field(const Fields& all, const MessageField& golden, const MessageField& actual);
  void compare_times(const std::string& path, std::int64_t expected, std::int64_t actual);
  void compare_bytes(const Fields& all, const MessageField& golden, const MessageField& actual);
  void compare_points(const Fields& all, std::vector<std::byte>& golden, std::vector<std::byte>& actual);
  void compare_numbers(const std::string& path, double expected, double actual, std::string_view unit);
  void report_lone(const MessageField& field, std::string note);
  void report(const std::string& path, std::string note);
  void report(Divergence divergence, bool beyond);
  bool has_column(const MessageField& field) const;
  Divergence place(const std::string& path) const;

  const ComparedTraces& traces_;
  const PairedChannel& channel_;
  ChannelFindings& findings_;
  const bool joins_times_;  // seconds and nanoseconds are one value
  const MatchedChannel* window_ = nullptr;
  std::unique_ptr<Decoders> decoders_;  // null: a schema is unknown
  std::size_t message_ = 0;             // index of the compared message of the golden
  bool found_ = false;
};

}  // namespace rehearse
