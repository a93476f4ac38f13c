#include "viewer_protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/trace/message_json.h"

namespace rehearse::viewer_protocol {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_items = 10'000;  // of a list in a request

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// A member that is a whole number of 32 bits.
std::optional<std::uint32_t> number_in(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  const auto number = found->get<std::uint64_t>();
  return number <= UINT32_MAX ? std::optional(static_cast<std::uint32_t>(number)) : std::nullopt;
}

Result<const Json*> list_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) return error(fmt::format("a request lacks its list '{}'", key));
  if (found->size() > most_items)
    return error(fmt::format("the list '{}' of a request is too long: {} items", key, found->size()));
  return &*found;
}

Result<std::optional<std::string>> id_in(const Json& object) {
  const auto found = object.find("id");
  if (found == object.end() || found->is_null()) return std::optional<std::string>();
  if (!found->is_string()) return error("the 'id' of a request is no text");
  return std::optional(found->get<std::string>());
}

Result<Request> subscribe_of(const Json& object) {
  Subscribe request;
  for (const Json& one : *REHEARSE_TRY(list_in(object, "subscriptions"))) {
    const auto id = number_in(one, "id"), channel = number_in(one, "channelId");
    if (!id || !channel) return error("a subscription lacks its numbers 'id' and 'channelId'");
    request.subscriptions.emplace_back(*id, *channel);
  }
  return Request(request);
}

Result<Request> unsubscribe_of(const Json& object) {
  Unsubscribe request;
  for (const Json& one : *REHEARSE_TRY(list_in(object, "subscriptionIds"))) {
    if (!one.is_number_unsigned() || one.get<std::uint64_t>() > UINT32_MAX)
      return error("'subscriptionIds' has an item that is no number of a subscription");
    request.subscriptions.push_back(one.get<std::uint32_t>());
  }
  return Request(request);
}

Result<Request> get_parameters_of(const Json& object) {
  GetParameters request;
  for (const Json& one : *REHEARSE_TRY(list_in(object, "parameterNames"))) {
    if (!one.is_string()) return error("'parameterNames' has an item that is no text");
    request.names.push_back(one.get<std::string>());
  }
  request.id = REHEARSE_TRY(id_in(object));
  return Request(request);
}

/// The next little-endian number of the bytes, which must be there.
template <class Number>
Number take(std::span<const std::byte>& bytes) {
  static_assert(std::endian::native == std::endian::little);
  Number number{};
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes = bytes.subspan(sizeof number);
  return number;
}

template <class Number>
void put(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

Json time_of(std::uint64_t ns) { return {{"sec", ns / 1'000'000'000}, {"nsec", ns % 1'000'000'000}}; }

/// Schemas that are bytes go as base64.
std::string sent_schema(const Channel& channel) {
  if (channel.schema_encoding != "protobuf" && channel.schema_encoding != "flatbuffer") return channel.schema;
  std::string text;
  append_base64(text, std::as_bytes(std::span(channel.schema)));
  return text;
}

}  // namespace

Result<Request> parse(std::string_view text) {
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return error("a request is no JSON object");
  const auto op = object.find("op");
  if (op == object.end() || !op->is_string()) return error("a request lacks its text 'op'");
  const auto& name = op->get_ref<const std::string&>();
  if (name == "subscribe") return subscribe_of(object);
  if (name == "unsubscribe") return unsubscribe_of(object);
  if (name == "getParameters") return get_parameters_of(object);
  if (name == "setParameters") return Request(SetParameters{REHEARSE_TRY(id_in(object))});
  if (name == "subscribeParameterUpdates" || name == "unsubscribeParameterUpdates")
    return Request(SubscribeParameters{});
  return error("this server has no such operation");
}

Result<Request> parse(std::span<const std::byte> bytes) {
  constexpr auto playback = std::byte{3};
  constexpr std::size_t head = 1 + 4 + 1 + 8 + 4;  // after the opcode [bytes]
  if (bytes.empty() || bytes[0] != playback) return error("this server has no such binary operation");
  bytes = bytes.subspan(1);
  if (bytes.size() < head) return error(fmt::format("a request for playback is cut: {} bytes", bytes.size()));
  Playback request;
  const auto command = take<std::uint8_t>(bytes);
  request.speed = take<float>(bytes);
  const auto seeks = take<std::uint8_t>(bytes);
  const auto time = take<std::uint64_t>(bytes);
  const auto size = take<std::uint32_t>(bytes);
  if (command > 1) return error(fmt::format("there is no command {} of playback", command));
  if (!std::isfinite(request.speed) || request.speed <= 0.0F) return error("a speed of playback is no number above 0");
  if (size != bytes.size()) return error("the identifier of a request for playback doesn't end with it");
  request.plays = command == 0;
  if (seeks != 0) request.seek = time;
  request.id.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return Request(request);
}

std::string server_info(const ServerInfo& info) {
  Json object{{"op", "serverInfo"},
              {"name", info.name},
              {"capabilities", {"time", "parameters", "parametersSubscribe"}},
              {"supportedEncodings", Json::array()},
              {"metadata", Json::object()},
              {"sessionId", info.session}};
  if (info.range) {
    object["capabilities"].push_back("playbackControl");
    object["dataStartTime"] = time_of(info.range->begin);
    object["dataEndTime"] = time_of(info.range->end);
  }
  return text_of(object);
}

std::string advertise(std::span<const Channel> channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    Json one{{"id", channel.id},
             {"topic", channel.topic},
             {"encoding", channel.encoding},
             {"schemaName", channel.schema_name},
             {"schema", sent_schema(channel)}};
    if (!channel.schema_encoding.empty()) one["schemaEncoding"] = channel.schema_encoding;
    list.push_back(std::move(one));
  }
  return text_of({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string status(Level level, std::string_view message) {
  return text_of({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}});
}

std::string parameter_values(const Json& values, std::span<const std::string> names,
                             const std::optional<std::string>& id) {
  Json list = Json::array();
  for (const auto& [name, value] : values.items())
    if (names.empty() || std::ranges::count(names, name) > 0) list.push_back({{"name", name}, {"value", value}});
  Json object{{"op", "parameterValues"}, {"parameters", std::move(list)}};
  if (id) object["id"] = *id;
  return text_of(object);
}

std::string message_head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string bytes(1, '\x01');
  put(bytes, subscription);
  put(bytes, time_ns);
  return bytes;
}

std::string time(std::uint64_t time_ns) {
  std::string bytes(1, '\x02');
  put(bytes, time_ns);
  return bytes;
}

std::string playback_state(PlaybackStatus status, std::uint64_t time_ns, float speed, std::string_view id) {
  std::string bytes(1, '\x05');
  bytes += static_cast<char>(status);
  put(bytes, time_ns);
  put(bytes, speed);
  put(bytes, static_cast<std::uint32_t>(id.size()));
  bytes += id;
  return bytes;
}

}  // namespace rehearse::viewer_protocol
