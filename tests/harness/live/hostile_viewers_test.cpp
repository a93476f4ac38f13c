// Strangers' handshakes and frames: each is refused or ends its own connection, and other viewers are served on.
#include <gmock/gmock.h>

#include "viewer_client.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;

constexpr const char* upgrade =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
constexpr const char* protocol = "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n";

/// A handshake with this first line and these fields before those of WebSocket.
std::string request(const std::string& line, const std::string& fields, bool upgrades = true) {
  return line + "\r\n" + fields + (upgrades ? std::string(upgrade) + protocol : "") + "\r\n";
}

struct Handshake {
  const char* name;
  std::string bytes;
  const char* answer;  // the start of the answer's first line after HTTP/1.1; empty: the connection ends without one
};

const std::string host = "Host: 127.0.0.1:PORT\r\n";
const std::string get = "GET /?token=TOKEN HTTP/1.1";

const std::vector<Handshake>& handshakes() {
  static const std::vector<Handshake> all{
      // who may connect: these show that the rows below can fail
      {"WithTheToken", request(get, host), "101"},
      {"ToLocalhost", request(get, "Host: localhost:PORT\r\n"), "101"},
      {"FromAPageOfThisMachine", request(get, host + "Origin: http://localhost:8080\r\n"), "101"},
      {"FromFoxglove", request(get, host + "Origin: https://app.foxglove.dev\r\n"), "101"},
      {"FromAProgram", request(get, host + "Origin: file://\r\n"), "101"},
      {"FromAnAllowedPage", request(get, host + "Origin: https://viewer.example.com\r\n"), "101"},
      {"TokenAmongOthers", request("GET /?a=1&token=TOKEN&b HTTP/1.1", host), "101"},
      // the token
      {"WithoutToken", request("GET / HTTP/1.1", host), "403"},
      {"EmptyToken", request("GET /?token= HTTP/1.1", host), "403"},
      {"OtherToken", request("GET /?token=00000000000000000000000000000000 HTTP/1.1", host), "403"},
      {"LongerToken", request("GET /?token=TOKEN0 HTTP/1.1", host), "403"},
      {"TokenInAnotherKey", request("GET /?xtoken=TOKEN HTTP/1.1", host), "403"},
      {"TokenInThePath", request("GET /TOKEN HTTP/1.1", host), "403"},
      {"TokenAfterAHash", request("GET /#?token= HTTP/1.1", host), "403"},
      {"TokenAsAField", request("GET / HTTP/1.1", host + "Authorization: Bearer TOKEN\r\n"), "403"},
      {"TokenTwice", request("GET /?token=no&token=TOKEN HTTP/1.1", host), "403"},
      {"OnlyAnds", request("GET /?&&&&& HTTP/1.1", host), "403"},
      // Host: another name that leads to this machine
      {"NoHost", request(get, ""), "400"},
      {"TwoHosts", request(get, host + host), "400"},
      {"EmptyHost", request(get, "Host:\r\n"), "403"},
      {"StrangersHost", request(get, "Host: evil.example.com\r\n"), "403"},
      {"StrangersHostWithThePort", request(get, "Host: evil.example.com:PORT\r\n"), "403"},
      {"HostThatBeginsAsLocalhost", request(get, "Host: localhost.evil.example.com:PORT\r\n"), "403"},
      {"HostWithAUser", request(get, "Host: localhost@evil.example.com:PORT\r\n"), "403"},
      {"HostWithoutPort", request(get, "Host: 127.0.0.1\r\n"), "403"},
      {"HostWithAnotherPort", request(get, "Host: 127.0.0.1:1\r\n"), "403"},
      // Origin: a page of a stranger in the user's browser
      {"StrangersPage", request(get, host + "Origin: https://evil.example.com\r\n"), "403"},
      {"SandboxedPage", request(get, host + "Origin: null\r\n"), "403"},
      {"PageThatBeginsAsLocalhost", request(get, host + "Origin: http://localhost.evil.example.com\r\n"), "403"},
      {"PageThatBeginsAsFoxglove", request(get, host + "Origin: https://app.foxglove.dev.evil.example.com\r\n"), "403"},
      {"FoxgloveWithoutTls", request(get, host + "Origin: http://app.foxglove.dev\r\n"), "403"},
      {"PageWithAUser", request(get, host + "Origin: http://localhost:80@evil.example.com\r\n"), "403"},
      {"TwoOrigins", request(get, host + "Origin: http://localhost\r\nOrigin: https://evil.example.com\r\n"), "400"},
      {"OriginWithControlBytes", request(get, host + "Origin: https://a\x1b[31m\r\n"), "400"},
      // no handshake
      {"NoUpgrade", request(get, host, false), "426"},
      {"AnotherPath", request("GET /etc/passwd?token=TOKEN HTTP/1.1", host), "404"},
      {"PathUpwards", request("GET /../../etc/passwd?token=TOKEN HTTP/1.1", host), "404"},
      {"Post", request("POST /?token=TOKEN HTTP/1.1", host), "405"},
      {"Head", request("HEAD /?token=TOKEN HTTP/1.1", host), "405"},
      {"Connect", request("CONNECT evil.example.com:443 HTTP/1.1", host), "403"},
      {"WithContent", request(get, host + "Content-Length: 4\r\n") + "abcd", "400"},
      {"WithChunks", request(get, host + "Transfer-Encoding: chunked\r\n") + "0\r\n\r\n", "400"},
      {"ContentAndChunks", request(get, host + "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n"), "400"},
      {"HugeContentLength", request(get, host + "Content-Length: 99999999999999999999999\r\n"), "400"},
      {"UnknownSubprotocol", get + "\r\n" + host + upgrade + "Sec-WebSocket-Protocol: chat\r\n\r\n", "400"},
      {"NoSubprotocol", get + "\r\n" + host + upgrade + "\r\n", "400"},
      {"NoKey",
       get + "\r\n" + host + "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n" + protocol +
           "\r\n",
       ""},
      {"OldVersion",
       get + "\r\n" + host +
           "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 8\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           protocol + "\r\n",
       ""},
      {"Http10", request("GET /?token=TOKEN HTTP/1.0", host), "426"},
      {"FramesBeforeTheAnswer", request(get, host) + WireFrame{.payload = "{}"}.bytes(), "400"},
      // no HTTP
      {"Garbage", "\x16\x03\x01\x02garbage of a TLS handshake\r\n\r\n", "400"},
      {"Zeros", std::string(200, '\0'), "400"},
      {"NoVersion", "GET /?token=TOKEN\r\n\r\n", "400"},
      {"NewlinesOnly", "\n\n\n\n\n\n", "400"},
      {"FieldWithoutColon", get + "\r\n" + host + "what is this\r\n\r\n", "400"},
      {"ZeroInAField", request(get, host + std::string("A: b\0c\r\n", 8)), "400"},
      {"FoldedField", request(get, host + "A: b\r\n\tc\r\n"), "101"},
      {"LongLine", "GET /?token=" + std::string(20'000, 'a') + " HTTP/1.1\r\n\r\n", "431"},
      {"LongField", request(get, host + "A: " + std::string(20'000, 'a') + "\r\n"), "431"},
      {"ManyFields",
       request(
           get, host +
                    [] {
                      std::string fields;
                      for (int i = 0; i < 2000; ++i) fields += fmt::format("F{}: a\r\n", i);
                      return fields;
                    }()),
       "431"},
  };
  return all;
}

class Handshakes : public ::testing::TestWithParam<Handshake> {};

/// One server for all rows: what one leaves behind, the next one meets.
RunningServer& server() {
  static RunningServer one;
  return one;
}

TEST_P(Handshakes, GetTheirAnswer) {
  const Handshake& row = GetParam();
  WireClient client(server().port());
  client.send(server().filled(row.bytes));
  if (*row.answer == '\0') {
    EXPECT_TRUE(client.wait_for_end()) << client.received();
    EXPECT_THAT(client.received(), testing::Not(HasSubstr(" 101 ")));
  } else {
    EXPECT_TRUE(client.wait_for("HTTP/1.1 " + std::string(row.answer) + " ")) << client.received();
  }
  if (std::string(row.answer) == "101") {
    EXPECT_TRUE(is_served(client));
    return;
  }
  EXPECT_THAT(client.received(), testing::Not(HasSubstr("serverInfo")));
  EXPECT_TRUE(client.wait_for_end()) << "a refused connection stays open";
  EXPECT_TRUE(is_served(*server().connected()));
}

const auto name_of_row = [](const auto& row) { return std::string(row.param.name); };
INSTANTIATE_TEST_SUITE_P(Hostile, Handshakes, ::testing::ValuesIn(handshakes()), name_of_row);

struct Sent {
  const char* name;
  std::string bytes;
  const char* answer;  // a part of the server's status; empty: the server ends the connection; "-": it goes on silently
};

std::string playback(char command, const std::string& speed, const std::string& rest) {
  return std::string("\x03", 1) + command + speed + rest;
}
const std::string one = {0, 0, static_cast<char>(0x80), 0x3f};  // 1.0
const std::string nan_bytes = {0, 0, static_cast<char>(0xc0), 0x7f};
const std::string infinite = {0, 0, static_cast<char>(0x80), 0x7f};
const std::string minus_one = {0, 0, static_cast<char>(0x80), static_cast<char>(0xbf)};
const std::string no_seek(9, '\0');
const std::string no_id(4, '\0');

std::string binary(const std::string& payload) { return WireFrame{.opcode = 2, .payload = payload}.bytes(); }
std::string seek_to(std::uint64_t time) {
  std::string bytes(1, '\1');
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(time >> (8 * i));
  return bytes;
}

const std::vector<Sent>& frames() {
  static const std::vector<Sent> all{
      // requests that make no sense: the viewer is told
      {"EmptyText", text_frame(""), "no JSON object"},
      {"NoJson", text_frame("{"), "no JSON object"},
      {"JsonList", text_frame("[]"), "no JSON object"},
      {"JsonNumber", text_frame("1e999"), "no JSON object"},
      {"DeepJson", text_frame(std::string(60'000, '[')), "no JSON object"},
      {"DeepObject", text_frame([] {
         std::string text;
         for (int i = 0; i < 10'000; ++i) text += "{\"a\":";
         return text;
       }()),
       "no JSON object"},
      {"NoOperation", text_frame("{}"), "lacks its text 'op'"},
      {"OperationIsANumber", text_frame(R"({"op":1})"), "lacks its text 'op'"},
      {"UnknownOperation", text_frame(R"({"op":"rm -rf"})"), "no such operation"},
      {"Publish", text_frame(R"({"op":"advertise","channels":[]})"), "no such operation"},
      {"FetchAsset", text_frame(R"({"op":"fetchAsset","uri":"file:///etc/passwd","requestId":1})"),
       "no such operation"},
      {"SubscribeNothing", text_frame(R"({"op":"subscribe"})"), "lacks its list"},
      {"SubscribeText", text_frame(R"({"op":"subscribe","subscriptions":"all"})"), "lacks its list"},
      {"SubscribeNumbers", text_frame(R"({"op":"subscribe","subscriptions":[1]})"), "lacks its numbers"},
      {"SubscribeNegative", text_frame(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
       "lacks its numbers"},
      {"SubscribeFraction", text_frame(R"({"op":"subscribe","subscriptions":[{"id":0.5,"channelId":1}]})"),
       "lacks its numbers"},
      {"SubscribeLarge", text_frame(R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})"),
       "lacks its numbers"},
      {"SubscribeUnknown", text_frame(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":77}]})"),
       "no channel 77"},
      {"SubscribeTwice",
       text_frame(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":1}]})"),
       "subscribed already"},
      {"SameIdTwice",
       text_frame(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":0,"channelId":2}]})"),
       "subscribed already"},
      {"ManySubscriptions", text_frame([] {
         std::string text = R"({"op":"unsubscribe","subscriptionIds":[0)";
         for (int i = 0; i < 10'000; ++i) text += ",0";
         return text + "]}";
       }()),
       "too long: 10001 items"},
      {"UnsubscribeText", text_frame(R"({"op":"unsubscribe","subscriptionIds":["a"]})"), "no number of a subscription"},
      {"UnsubscribeUnknown", text_frame(R"({"op":"unsubscribe","subscriptionIds":[99]})"), "-"},
      {"ParameterNumbers", text_frame(R"({"op":"getParameters","parameterNames":[1]})"), "no text"},
      {"ParameterId", text_frame(R"({"op":"getParameters","parameterNames":[],"id":{}})"), "is no text"},
      {"SetParameters", text_frame(R"({"op":"setParameters","parameters":[{"name":"time_step","value":1}]})"),
       "can't be changed"},
      {"DoubleKey", text_frame(R"({"op":"x","op":"unsubscribe","subscriptionIds":[]})"), "-"},
      {"EmptyBytes", binary(""), "no such binary operation"},
      {"ClientMessage", binary(std::string("\x01\0\0\0\0abc", 8)), "no such binary operation"},
      {"ServiceCall", binary(std::string("\x02\0\0\0\0\0\0\0\0", 9)), "no such binary operation"},
      {"PlaybackCut", binary(std::string("\x03\0\0", 3)), "is cut"},
      {"PlaybackCommand", binary(playback('\x09', one, no_seek + no_id)), "no command 9"},
      {"PlaybackNan", binary(playback('\0', nan_bytes, no_seek + no_id)), "no number above 0"},
      {"PlaybackInfinite", binary(playback('\0', infinite, no_seek + no_id)), "no number above 0"},
      {"PlaybackBackwards", binary(playback('\0', minus_one, no_seek + no_id)), "no number above 0"},
      {"PlaybackStopped", binary(playback('\0', std::string(4, '\0'), no_seek + no_id)), "no number above 0"},
      {"PlaybackLongId", binary(playback('\0', one, no_seek + std::string(4, '\xff'))), "doesn't end with it"},
      {"PlaybackMore", binary(playback('\0', one, no_seek + no_id + "more")), "doesn't end with it"},
      {"SeekFarAway", binary(playback('\0', one, seek_to(UINT64_MAX) + no_id)), "-"},
      // what the protocol of WebSocket allows
      {"Ping", WireFrame{.opcode = 9, .payload = "a"}.bytes(), "-"},
      {"Pong", WireFrame{.opcode = 10}.bytes(), "-"},
      {"TextInParts",
       WireFrame{.payload = "{", .is_last = false}.bytes() + WireFrame{.opcode = 0, .payload = "}"}.bytes(),
       "lacks its text 'op'"},
      {"PingBetweenParts",
       WireFrame{.payload = "{", .is_last = false}.bytes() + WireFrame{.opcode = 9}.bytes() +
           WireFrame{.opcode = 0, .payload = "}"}.bytes(),
       "lacks its text 'op'"},
      {"ManyPings",
       [] {
         std::string bytes;
         for (int i = 0; i < 5000; ++i) bytes += WireFrame{.opcode = 9, .payload = "ping"}.bytes();
         return bytes;
       }(),
       "-"},
      // what it doesn't: the connection ends
      {"Unmasked", WireFrame{.payload = "{}", .is_masked = false}.bytes(), ""},
      {"ReservedBit1", WireFrame{.payload = "{}", .reserved = 4}.bytes(), ""},
      {"ReservedBit3", WireFrame{.payload = "{}", .reserved = 1}.bytes(), ""},
      {"UnknownOpcode", WireFrame{.opcode = 3, .payload = "{}"}.bytes(), ""},
      {"UnknownControl", WireFrame{.opcode = 11}.bytes(), ""},
      {"RestWithoutStart", WireFrame{.opcode = 0, .payload = "{}"}.bytes(), ""},
      {"TwoStarts", WireFrame{.payload = "{", .is_last = false}.bytes() + WireFrame{.payload = "}"}.bytes(), ""},
      {"LongPing", WireFrame{.opcode = 9, .payload = std::string(126, 'a')}.bytes(), ""},
      {"PingInParts", WireFrame{.opcode = 9, .is_last = false}.bytes(), ""},
      {"TextIsNoUtf8", text_frame("\xff\xfe"), ""},
      {"SizeInTooManyBytes", WireFrame{.payload = "{}", .width = 2}.bytes(), ""},
      {"SizeInEightBytes", WireFrame{.payload = "{}", .width = 8}.bytes(), ""},
      {"LongMessage", text_frame(std::string(70'000, ' ')), ""},
      {"LongMessageInParts",
       [] {
         std::string bytes = WireFrame{.payload = std::string(60'000, ' '), .is_last = false}.bytes();
         return bytes + WireFrame{.opcode = 0, .payload = std::string(60'000, ' ')}.bytes();
       }(),
       ""},
      {"StatedSizeOfGigabytes", WireFrame{.stated = 2'000'000'000}.bytes(), ""},
      {"Close", WireFrame{.opcode = 8}.bytes(), ""},
      {"CloseWithACode", WireFrame{.opcode = 8, .payload = "\x03\xe8"}.bytes(), ""},
      {"CloseWithOneByte", WireFrame{.opcode = 8, .payload = "a"}.bytes(), ""},
      {"CloseWithABadCode", WireFrame{.opcode = 8, .payload = std::string("\0\1", 2)}.bytes(), ""},
      {"CloseReasonIsNoUtf8", WireFrame{.opcode = 8, .payload = "\x03\xe8\xff"}.bytes(), ""},
      {"GarbageFrames", std::string(1000, '\xee'), ""},
  };
  return all;
}

class Frames : public ::testing::TestWithParam<Sent> {};

TEST_P(Frames, GetTheirAnswer) {
  const Sent& row = GetParam();
  const auto other = server().connected();
  const auto client = server().connected();
  client->forget();
  client->send(row.bytes);
  const std::string answer = row.answer;
  if (answer.empty()) {
    EXPECT_TRUE(client->wait_for_end());
  } else {
    if (answer != "-") {
      EXPECT_TRUE(client->wait_for(answer)) << client->received();
    }
    EXPECT_TRUE(is_served(*client));
  }
  EXPECT_TRUE(is_served(*other));
}

INSTANTIATE_TEST_SUITE_P(Hostile, Frames, ::testing::ValuesIn(frames()), name_of_row);

TEST(HostileViewers, AreAtLeastAsManyAsThePagesState) { EXPECT_GE(handshakes().size() + frames().size(), 125U); }

TEST(HostileViewers, ThatVanishAreForgotten) {
  for (const std::size_t sent : {0, 1, 20, 100, 200}) {
    WireClient client(server().port());
    client.send(server().handshake().substr(0, sent));
  }
  for (int i = 0; i < 40; ++i) {
    const auto client = server().connected();
    client->send(text_frame(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})").substr(0, 1 + i));
  }
  EXPECT_TRUE(is_served(*server().connected()));
}

TEST(HostileViewers, WithoutAHandshakeAreClosedAfterFiveSeconds) {
  WireClient client(server().port());
  client.send("GET /");
  EXPECT_TRUE(client.wait_for_end(8000));
}

TEST(HostileViewers, AreToldOnceOnTheTerminal) {
  WireClient client(server().port());
  client.send(server().filled(request(get, host + "Origin: https://told.example.com\r\n")));
  EXPECT_TRUE(client.wait_for_end());
  EXPECT_TRUE(server().was_told("pages of https://told.example.com may not connect"));
}

TEST(HostileViewers, AreSixteenAtMost) {
  RunningServer own;
  std::vector<std::unique_ptr<WireClient>> clients;
  for (int i = 0; i < 16; ++i) clients.push_back(own.connected());
  WireClient one_more(own.port());
  EXPECT_TRUE(one_more.wait_for_end());
  clients.pop_back();
  for (int i = 0; i < 100; ++i) {  // until the server has seen the end
    WireClient again(own.port());
    again.send(own.handshake());
    if (again.wait_for("advertise", 1000)) return;
  }
  ADD_FAILURE() << "no place became free";
}

TEST(SlowViewers, LoseMessagesAreToldAndDelayNobody) {
  RunningServer own;
  const auto slow = own.connected(), quick = own.connected();
  const std::string subscribe = text_frame(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":2}]})");
  slow->send(subscribe);
  quick->send(subscribe);
  EXPECT_TRUE(is_served(*slow));
  EXPECT_TRUE(is_served(*quick));
  constexpr std::size_t size = 1 << 20;
  std::size_t got = 0;
  for (int i = 0; i < 64; ++i) {  // 64 MiB, four times a queue
    own.publish(2, size);
    while (got < (static_cast<std::size_t>(i) + 1) * size && quick->wait_for("", 0)) {
      quick->forget();
      if (!quick->wait_for(std::string(1, '\0'), 5000)) break;
      got += quick->received().size();
    }
  }
  EXPECT_GE(got, 64 * size);  // also the heads of messages
  EXPECT_TRUE(slow->wait_for("takes them too slowly", 20'000));
  const std::size_t of_slow = slow->received().size();
  EXPECT_LT(of_slow, 40 * size);
  EXPECT_GT(of_slow, 8 * size);
}

TEST(Ports, ThatAreInUseNameTheirProgram) {
  const auto again = ViewerServer::listen({server().port(), {}, [](const std::string&) {}}, {});
  ASSERT_FALSE(again);
  EXPECT_THAT(again.errors()[0].message, HasSubstr(fmt::format("live_test (process {}) has the port", getpid())));
}

}  // namespace
}  // namespace rehearse::test
