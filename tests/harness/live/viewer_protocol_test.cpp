// The messages of the protocol, byte by byte.
#include "viewing/live/viewer_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "viewing/live/web_server.h"

namespace rehearse::viewer_protocol {
namespace {

using testing::ElementsAre;
using testing::Pair;
using Json = nlohmann::ordered_json;

template <class T>
T parsed(std::string_view text) {
  const auto request = parse(text);
  EXPECT_TRUE(request) << text;
  return request && std::holds_alternative<T>(*request) ? std::get<T>(*request) : T();
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(ViewerProtocol, ReadsRequests) {
  EXPECT_THAT(parsed<Subscribe>(
                  R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})")
                  .subscriptions,
              ElementsAre(Pair(0, 3), Pair(4294967295U, 5)));
  EXPECT_THAT(parsed<Unsubscribe>(R"({"op":"unsubscribe","subscriptionIds":[0,1]})").subscriptions, ElementsAre(0, 1));
  const auto get = parsed<GetParameters>(R"({"op":"getParameters","parameterNames":["a","b"],"id":"7"})");
  EXPECT_THAT(get.names, ElementsAre("a", "b"));
  EXPECT_EQ(get.id, "7");
  EXPECT_EQ(parsed<SetParameters>(R"({"op":"setParameters","parameters":[],"id":"8"})").id, "8");
}

TEST(ViewerProtocol, ReadsPlayback) {
  using namespace std::string_literals;
  const std::string bytes = "\x03\x01\x00\x00\x00\x40\x01\x15\xcd\x5b\x07\x00\x00\x00\x00\x02\x00\x00\x00id"s;
  const auto request = parse(bytes_of(bytes));
  ASSERT_TRUE(request && std::holds_alternative<Playback>(*request));
  const auto& playback = std::get<Playback>(*request);
  EXPECT_FALSE(playback.plays);
  EXPECT_EQ(playback.speed, 2.0F);
  EXPECT_EQ(playback.seek, 123456789U);
  EXPECT_EQ(playback.id, "id");
}

TEST(ViewerProtocol, WritesServerInfo) {
  const Json live = Json::parse(server_info({.name = "a", .session = "s", .range = {}}));
  EXPECT_EQ(live["op"], "serverInfo");
  EXPECT_THAT(live["capabilities"], ElementsAre("time", "parameters", "parametersSubscribe"));
  EXPECT_FALSE(live.contains("dataStartTime"));
  const Json played =
      Json::parse(server_info({.name = "a", .session = "s", .range = ServerInfo::Range{1'500'000'000, 2'000'000'001}}));
  EXPECT_THAT(played["capabilities"], ElementsAre("time", "parameters", "parametersSubscribe", "playbackControl"));
  EXPECT_EQ(played["dataStartTime"], Json::parse(R"({"sec":1,"nsec":500000000})"));
  EXPECT_EQ(played["dataEndTime"], Json::parse(R"({"sec":2,"nsec":1})"));
}

TEST(ViewerProtocol, WritesChannels) {
  const Channel channels[] = {{1, "/a", "cdr", "A", "ros2msg", "int32 a"},
                              {2, "/b", "protobuf", "B", "protobuf", "\x01\x02\x03"}};
  const Json written = Json::parse(advertise(channels));
  EXPECT_EQ(written, Json::parse(R"({"op":"advertise","channels":[
      {"id":1,"topic":"/a","encoding":"cdr","schemaName":"A","schema":"int32 a","schemaEncoding":"ros2msg"},
      {"id":2,"topic":"/b","encoding":"protobuf","schemaName":"B","schema":"AQID","schemaEncoding":"protobuf"}]})"));
}

TEST(ViewerProtocol, WritesParametersThatAreAskedFor) {
  const Json values = {{"a", 1}, {"b", "two"}};
  const std::string name = "b";
  EXPECT_EQ(Json::parse(parameter_values(values, {&name, 1}, "9")),
            Json::parse(R"({"op":"parameterValues","parameters":[{"name":"b","value":"two"}],"id":"9"})"));
  EXPECT_EQ(Json::parse(parameter_values(values, {}, {}))["parameters"].size(), 2U);
}

TEST(ViewerProtocol, WritesBytes) {
  using namespace std::string_literals;
  EXPECT_EQ(message_head(0x01020304, 0x1122334455667788), "\x01\x04\x03\x02\x01\x88\x77\x66\x55\x44\x33\x22\x11"s);
  EXPECT_EQ(time(5), "\x02\x05\0\0\0\0\0\0\0"s);
  EXPECT_EQ(playback_state(PlaybackStatus::ended, 6, 1.0F, "ab"),
            "\x05\x03\x06\0\0\0\0\0\0\0\0\0\x80\x3f\x02\0\0\0ab"s);
}

TEST(ViewerProtocol, ReplacesBadTextInNames) {
  const Channel channel{1, "/\xff", "cdr", "A", "ros2msg", "\xfe"};
  EXPECT_TRUE(Json::accept(advertise({&channel, 1})));
  EXPECT_TRUE(Json::accept(status(Level::error, "\xff")));
}

TEST(Tokens, HaveThirtyTwoDigitsAndDiffer) {
  const auto a = new_token(), b = new_token();
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->size(), 32U);
  EXPECT_EQ(a->find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(*a, *b);
}

}  // namespace
}  // namespace rehearse::viewer_protocol
