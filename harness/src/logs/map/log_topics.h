// LogTopic: the contents of a log's topic that are needed to read numbers from it.
#pragma once

#include <rehearse/mcap.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/ros2msg/ros2msg.h"

namespace rehearse {

/// The content of a message field, independent of its width.
enum class FieldContent { number, text, bytes };

struct LogTopic {
  std::string name;  // as /joint_states
  std::string type;  // as sensor_msgs/msg/JointState; empty if there is no schema
  /// The fields of its messages: paths with / between names, * for the elements of arrays and sequences: name/*, data,
  /// header/stamp/sec, transforms/*/child_frame_id.
  std::map<std::string, FieldContent> fields;
  std::string schema;           // its text
  ros2msg::Schema definitions;  // the schema, as read; none with a problem
  std::string problem;          // why its messages can't be decoded; empty: they can

  bool has(std::string_view path, FieldContent content = FieldContent::number) const;
};

/// A topic with messages of that type. A schema that can't be read is the topic's problem.
LogTopic log_topic(std::string name, std::string message_encoding, const mcap::Schema* schema);

/// The topics of a log, sorted by name. Channels of one topic are merged; different types become the topic's problem.
std::vector<LogTopic> topics_of(const mcap::Reader& log);

}  // namespace rehearse
