#include "message_print.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "core/ros2msg/message_format.h"
#include "message_json.h"

namespace rehearse {

namespace {

std::string_view text_of(mcap::Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// The text with at most two of the digits in a row outside of quotes, which keeps valid JSON valid and other texts
/// invalid: the parser refuses numbers beyond the range of a double.
std::string with_short_numbers(std::string_view json) {
  std::string text;
  bool quoted = false;
  int digits = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    digits = !quoted && c >= '0' && c <= '9' ? digits + 1 : 0;
    if (digits > 2) continue;
    text += c;
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\' && i + 1 < json.size()) text += json[++i];
  }
  return text;
}

/// The JSON text without the blanks between its tokens; nullopt if it isn't JSON.
std::optional<std::string> without_blanks(std::string_view json) {
  if (!nlohmann::json::accept(json) && !nlohmann::json::accept(with_short_numbers(json))) return std::nullopt;
  std::string text;
  text.reserve(json.size());
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (!quoted && (c == ' ' || c == '\t' || c == '\n' || c == '\r')) continue;
    text += c;
    if (c == '"') quoted = !quoted;
    if (quoted && c == '\\') text += json[++i];
  }
  return text;
}

/// The message as JSON or as a line; fails with the reason if it can't be decoded.
Result<std::string> decode(ros2msg::Decoder* decoder, mcap::Bytes data, MessagePrinter::Form form) {
  if (decoder != nullptr) {
    return form == MessagePrinter::Form::json ? ros2msg::to_json(*decoder, data) : ros2msg::to_line(*decoder, data);
  }
  if (auto json = without_blanks(text_of(data))) return std::move(*json);
  return error("the payload isn't JSON");
}

}  // namespace

std::string_view MessagePrinter::print(const mcap::Message& message, const mcap::Schema* schema) {
  text_.clear();
  if (form_ == Form::json) {
    print_json(message, schema);
  } else {
    print_line(message, schema);
  }
  text_ += '\n';
  return text_;
}

MessagePrinter::Decoding& MessagePrinter::decoding_of(const mcap::Channel& channel, const mcap::Schema* schema) {
  const auto known = decodings_.find(channel.id);
  if (known != decodings_.end()) return known->second;
  Decoding& decoding = decodings_[channel.id];
  decoding.is_json = channel.message_encoding == "json";
  // JSON is printed as it is, with what its schema doesn't mention
  if (decoding.is_json || !ros2msg::is_decodable(channel.message_encoding, schema)) return decoding;
  auto parsed = ros2msg::schema_of(channel.message_encoding, *schema, "schema " + schema->name);
  if (parsed) {
    decoding.decoder.emplace(std::move(*parsed));
  } else {
    decoding.problem = to_string(parsed.errors().front());
  }
  return decoding;
}

void MessagePrinter::print_json(const mcap::Message& message, const mcap::Schema* schema) {
  const mcap::Channel& channel = *message.channel;
  text_ += "{\"topic\":";
  append_json(text_, channel.topic);
  fmt::format_to(std::back_inserter(text_), ",\"log_time\":{},\"publish_time\":{},\"sequence\":{},", message.log_time,
                 message.publish_time, message.sequence);
  Decoding& decoding = decoding_of(channel, schema);
  std::string problem = decoding.problem;
  if (decoding.decoder || decoding.is_json) {
    const auto decoded = decode(decoding.decoder ? &*decoding.decoder : nullptr, message.data, form_);
    if (decoded) {
      text_ += "\"message\":" + *decoded + '}';
      return;
    }
    problem = decoded.errors().front().message;
  }
  text_ += "\"encoding\":";
  append_json(text_, channel.message_encoding);
  text_ += ",\"schema\":";
  if (schema == nullptr) {
    text_ += "null";
  } else {
    append_json(text_, schema->name);
  }
  if (!problem.empty()) {
    text_ += ",\"error\":";
    append_json(text_, problem);
  }
  text_ += ",\"data\":\"";
  append_base64(text_, message.data);
  text_ += "\"}";
}

void MessagePrinter::print_line(const mcap::Message& message, const mcap::Schema* schema) {
  constexpr std::uint64_t second = 1'000'000'000;
  const mcap::Channel& channel = *message.channel;
  std::string topic;
  append_json(topic, channel.topic);  // characters that would disturb a terminal are escaped
  fmt::format_to(std::back_inserter(text_), "{}.{:09} {} ", message.log_time / second, message.log_time % second,
                 std::string_view(topic).substr(1, topic.size() - 2));
  Decoding& decoding = decoding_of(channel, schema);
  std::string problem = decoding.problem;
  if (decoding.decoder || decoding.is_json) {
    const auto decoded = decode(decoding.decoder ? &*decoding.decoder : nullptr, message.data, form_);
    if (decoded) {
      text_ += *decoded;
      return;
    }
    problem = decoded.errors().front().message;
  }
  std::string encoding;
  append_json(encoding, channel.message_encoding);
  fmt::format_to(std::back_inserter(text_), "({} bytes of encoding {}{}{})", message.data.size(), encoding,
                 problem.empty() ? "" : ": ", problem);
}

}  // namespace rehearse
