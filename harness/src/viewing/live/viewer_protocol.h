// The messages of Foxglove's WebSocket protocol, version 1, which Foxglove and Lichtblick speak. Internal.
//
// Requests are read from a stranger's bytes: each is one of the types below, or one Diagnostic says what is wrong.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rehearse::viewer_protocol {

/// Names of the subprotocol, the best first. Lichtblick and older versions of Foxglove know the second.
inline constexpr const char* subprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;     // of messages, as "cdr"
  std::string schema_name;  // as "sensor_msgs/msg/JointState"
  std::string schema_encoding;
  std::string schema;  // its bytes
};

struct Subscribe {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> subscriptions;  // the client's number, and the channel
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions;
};
struct GetParameters {
  std::vector<std::string> names;  // empty: all
  std::optional<std::string> id;   // to repeat in the answer
};
struct SetParameters {
  std::optional<std::string> id;
};
/// Parameters never change, so there is nothing to send to a subscriber.
struct SubscribeParameters {};
struct Playback {
  bool plays = false;
  float speed = 1.0F;                 // finite, above 0
  std::optional<std::uint64_t> seek;  // [ns]
  std::string id;                     // to repeat in the answer
};
using Request = std::variant<Subscribe, Unsubscribe, GetParameters, SetParameters, SubscribeParameters, Playback>;

Result<Request> parse(std::string_view text);
Result<Request> parse(std::span<const std::byte> bytes);

struct ServerInfo {
  std::string name, session;
  struct Range {
    std::uint64_t begin = 0, end = 0;  // log times [ns]
  };
  std::optional<Range> range;  // of a recording that can be played; none: it grows
};
std::string server_info(const ServerInfo& info);
std::string advertise(std::span<const Channel> channels);

enum class Level { info = 0, warning = 1, error = 2 };
std::string status(Level level, std::string_view message);

/// `values`: an object. `names`: those to send; empty: all.
std::string parameter_values(const nlohmann::ordered_json& values, std::span<const std::string> names,
                             const std::optional<std::string>& id);

/// The bytes before the data of a message.
std::string message_head(std::uint32_t subscription, std::uint64_t time_ns);
std::string time(std::uint64_t time_ns);

enum class PlaybackStatus { playing = 0, paused = 1, buffering = 2, ended = 3 };
/// `id`: of the request that is answered; empty: of none.
std::string playback_state(PlaybackStatus status, std::uint64_t time_ns, float speed, std::string_view id);

}  // namespace rehearse::viewer_protocol
