#include "message_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "other_schemas.h"

namespace rehearse::ros2msg {
namespace {

struct Format {
  std::string_view message_encoding, schema_encoding;
  Encoding encoding;
  Result<Schema> (*parse)(std::string_view type, std::string_view text, std::string file);
};

constexpr Format formats[] = {
    {"cdr", "ros2msg", Encoding::cdr, &Schema::parse},
    {"cdr", "ros2idl", Encoding::cdr, &parse_idl},
    {"ros1", "ros1msg", Encoding::ros1, &parse_ros1},
    {"json", "jsonschema", Encoding::json, &parse_json_schema},
    {"protobuf", "protobuf", Encoding::protobuf, &parse_protobuf},
};

const Format* find_format(std::string_view message_encoding, std::string_view schema_encoding) {
  const auto fits = [&](const Format& format) {
    return format.message_encoding == message_encoding && format.schema_encoding == schema_encoding;
  };
  const auto found = std::ranges::find_if(formats, fits);
  return found == std::end(formats) ? nullptr : found;
}

Result<Schema> parse(const Format& format, const mcap::Schema& schema, std::string file) {
  auto parsed = format.parse(schema.name, schema.data, std::move(file));
  if (parsed) parsed->encoding = format.encoding;
  return parsed;
}

}  // namespace

bool is_decodable(std::string_view message_encoding, const mcap::Schema* schema) {
  return schema && find_format(message_encoding, schema->encoding);
}

Result<Schema> schema_of(std::string_view message_encoding, const mcap::Schema& schema, std::string file) {
  const Format* format = find_format(message_encoding, schema.encoding);
  if (!format)
    return error(fmt::format("messages of encoding '{}' with a schema in '{}' can't be decoded", message_encoding,
                             schema.encoding));
  return parse(*format, schema, std::move(file));
}

std::optional<Diagnostic> problem_of(const mcap::Schema& schema) {
  const auto fits = [&](const Format& format) { return format.schema_encoding == schema.encoding; };
  const auto format = std::ranges::find_if(formats, fits);
  if (format == std::end(formats)) return std::nullopt;
  const auto parsed = parse(*format, schema, {});
  return parsed ? std::nullopt : std::optional(parsed.errors().front());
}

}  // namespace rehearse::ros2msg
