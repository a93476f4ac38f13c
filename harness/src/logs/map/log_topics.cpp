#include "log_topics.h"

#include <fmt/format.h>

#include "core/ros2msg/message_format.h"

namespace rehearse {
namespace {

/// More than any message has. The limit rejects schemas whose types unfold to millions of fields.
constexpr std::size_t max_fields = 10'000;

class FieldList {
 public:
  FieldList(const ros2msg::Schema& schema, std::map<std::string, FieldContent>& fields)
      : schema_(schema), fields_(fields) {}

  /// Adds the fields of a type; false: there are too many.
  bool add(const ros2msg::Definition& definition, const std::string& prefix) {
    for (const ros2msg::FieldDefinition& field : definition.fields) {
      const ros2msg::FieldType& type = field.type;
      const bool many = type.shape != ros2msg::FieldType::Shape::single;
      std::string path = prefix + field.name;
      if (type.is_message) {
        if (!add(schema_.definitions[type.message], path + (many ? "/*/" : "/"))) return false;
      } else if (many && type.primitive == ros2msg::Primitive::uint8) {
        fields_.emplace(std::move(path), FieldContent::bytes);
      } else {
        const bool text = type.primitive == ros2msg::Primitive::string;
        fields_.emplace(many ? path + "/*" : path, text ? FieldContent::text : FieldContent::number);
      }
      if (fields_.size() > max_fields) return false;
    }
    return true;
  }

 private:
  const ros2msg::Schema& schema_;
  std::map<std::string, FieldContent>& fields_;
};

}  // namespace

bool LogTopic::has(std::string_view path, FieldContent content) const {
  const auto field = fields.find(std::string(path));
  return field != fields.end() && field->second == content;
}

LogTopic log_topic(std::string name, std::string message_encoding, const mcap::Schema* schema) {
  LogTopic topic;
  topic.name = std::move(name);
  if (!schema) {
    topic.problem = fmt::format("it has no schema; its messages are encoded as '{}'", message_encoding);
    return topic;
  }
  topic.type = schema->name;
  topic.schema = schema->data;
  if (schema->encoding.empty() && schema->data.empty()) {
    topic.problem = fmt::format("the log has no definition of {}, and it is no standard type", schema->name);
    return topic;
  }
  if (!ros2msg::is_decodable(message_encoding, schema)) {
    topic.problem = fmt::format("messages of encoding '{}' with a schema in '{}' can't be read", message_encoding,
                                schema->encoding);
    return topic;
  }
  const auto parsed = ros2msg::schema_of(message_encoding, *schema);
  if (!parsed) {
    topic.problem = fmt::format("its schema can't be read: {}", parsed.errors()[0].message);
  } else if (!FieldList(*parsed, topic.fields).add(parsed->definitions[0], "")) {
    topic.problem = fmt::format("its messages have more than {} fields", max_fields);
  } else {
    topic.definitions = *parsed;
  }
  return topic;
}

std::vector<LogTopic> topics_of(const mcap::Reader& log) {
  std::map<std::string, LogTopic> by_name;
  for (const auto& [id, channel] : log.channels()) {
    LogTopic topic = log_topic(channel.topic, channel.message_encoding, log.schema_of(channel));
    const auto [known, is_new] = by_name.emplace(channel.topic, topic);
    if (is_new || (known->second.type == topic.type && known->second.schema == topic.schema)) continue;
    known->second.problem =
        known->second.type == topic.type
            ? fmt::format("it has messages of two versions of {}", topic.type)
            : fmt::format("it has messages of two types, {} and {}", known->second.type, topic.type);
  }
  std::vector<LogTopic> topics;
  for (auto& [name, topic] : by_name) topics.push_back(std::move(topic));
  return topics;
}

}  // namespace rehearse
