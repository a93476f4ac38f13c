// Requests to a server with a page: the page is served to who asks by the server's own name, and all else only with the
// token, from the page itself.
#include <gmock/gmock.h>

#include "viewer_client.h"
#include "viewing/live/web_server.h"

namespace rehearse::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* page = "<!doctype html><p>a page without secrets</p>";

/// A server with a page and one address, /echo, in a thread of its own.
class PageServer : WebServer::Handler {
 public:
  PageServer() {
    WebServer::Options options;
    options.token = token_;
    options.page = page;
    options.longest_request = 1000;
    options.handshake_limit = std::chrono::milliseconds(1000);
    auto listening = WebServer::listen(std::move(options), *this);
    EXPECT_TRUE(listening) << to_string(listening.errors());
    server_ = *std::move(listening);
    thread_ = std::thread([this] {
      while (!stopped_) server_->run_for(std::chrono::milliseconds(2));
    });
  }
  ~PageServer() override {
    stopped_ = true;
    thread_.join();
    server_->stop();
  }

  /// All that the server answers to these bytes, in which PORT and TOKEN are replaced.
  std::string answer_to(std::string bytes, int patience = 5000) {
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"PORT", std::to_string(server_->port())}, {"TOKEN", token_}})
      for (std::size_t at = 0; (at = bytes.find(name, at)) != std::string::npos; at += value.size())
        bytes.replace(at, name.size(), value);
    WireClient client(server_->port());
    client.send(bytes);
    client.wait_for_end(patience);
    return client.received();
  }
  /// The requests that the handler got.
  int asked_for() const { return asked_for_; }

 private:
  void opened(WebServer::Client client, std::string_view /*protocol*/) override { server_->send_text(client, "hello"); }
  void took_text(WebServer::Client /*client*/, std::string_view /*text*/) override {}
  void took_bytes(WebServer::Client /*client*/, std::span<const std::byte> /*bytes*/) override {}
  void closed(WebServer::Client /*client*/) override {}
  void refused(const std::string& /*reason*/) override {}
  std::optional<WebServer::Answer> asked(const WebServer::Request& request) override {
    ++asked_for_;
    if (request.path != "/echo") return std::nullopt;
    return WebServer::Answer{200, "text/plain", (request.is_post ? "post " : "get ") + std::string(request.body)};
  }

  const std::string token_ = "0123456789abcdef0123456789abcdef";
  std::unique_ptr<WebServer> server_;
  std::thread thread_;
  std::atomic<bool> stopped_ = false;
  std::atomic<int> asked_for_ = 0;
};

const std::string own_host = "Host: 127.0.0.1:PORT\r\n";
const std::string own_origin = "Origin: http://127.0.0.1:PORT\r\n";
const std::string with_token = "Authorization: Bearer TOKEN\r\n";

std::string post(const std::string& fields, const std::string& body, const std::string& path = "/echo") {
  return "POST " + path + " HTTP/1.1\r\n" + fields + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
         body;
}

TEST(Pages, ThePageNeedsNoTokenAndMayConnectToItsServerAlone) {
  PageServer server;
  const std::string answer = server.answer_to("GET / HTTP/1.1\r\n" + own_host + "\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_TRUE(answer.ends_with(page));
  EXPECT_THAT(answer, HasSubstr("connect-src 'self'"));
  EXPECT_THAT(answer, HasSubstr("frame-ancestors 'none'"));
  EXPECT_EQ(server.asked_for(), 0);
}

TEST(Pages, ARequestWithTheTokenIsAnswered) {
  PageServer server;
  EXPECT_TRUE(server.answer_to(post(own_host + own_origin + with_token, "{\"a\": 1}")).ends_with("post {\"a\": 1}"));
  EXPECT_TRUE(server.answer_to("GET /echo?x=1 HTTP/1.1\r\n" + own_host + with_token + "\r\n").ends_with("get "));
  EXPECT_THAT(server.answer_to(post(own_host + with_token, "{}", "/etc/passwd")), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(server.answer_to(post("Host: localhost:PORT\r\nOrigin: http://localhost:PORT\r\n" + with_token, "")),
              StartsWith("HTTP/1.1 200"));
}

TEST(Pages, AStrangersRequestIsRefusedAndNotHandledEither) {
  const std::vector<std::pair<std::string, std::string>> requests{
      {"403", post(own_host + own_origin, "{}")},                                           // without the token
      {"403", post(own_host + own_origin + "Authorization: Bearer 0\r\n", "{}")},           // another one
      {"403", post(own_host + own_origin + "Authorization: Basic TOKEN\r\n", "{}")},        // in another scheme
      {"403", post(own_host + own_origin + "Cookie: token=TOKEN\r\n", "{}")},               // where a browser puts it
      {"403", post(own_host + own_origin, "{}", "/echo?token=TOKEN")},                      // in the address
      {"403", post(own_host + own_origin, "token=TOKEN")},                                  // in a form
      {"403", "GET /echo HTTP/1.1\r\n" + own_host + "\r\n"},                                // a link
      {"403", "GET //echo HTTP/1.1\r\n" + own_host + "\r\n"},                               //
      {"403", post(own_host + "Origin: http://127.0.0.1:1\r\n" + with_token, "{}")},        // another server here
      {"403", post(own_host + "Origin: http://localhost:PORT\r\n" + with_token, "{}")},     // another name of this one
      {"403", post(own_host + "Origin: https://127.0.0.1:PORT\r\n" + with_token, "{}")},    //
      {"403", post(own_host + "Origin: null\r\n" + with_token, "{}")},                      // a report in its frame
      {"403", post(own_host + "Origin: https://evil.example.com\r\n" + with_token, "{}")},  // a page in the browser
      {"403", post("Host: evil.example.com:PORT\r\n" + with_token, "{}")},                  // DNS rebinding
      {"403", "GET / HTTP/1.1\r\nHost: evil.example.com:PORT\r\n\r\n"},                     // likewise, for the page
      {"400", post(own_host + own_host + with_token, "{}")},                                //
      {"405", "DELETE /echo HTTP/1.1\r\n" + own_host + with_token + "\r\n"},                //
      {"413", post(own_host + with_token, std::string(2000, 'a'))},                         // too long
      {"403", "GET / HTTP/1.1\r\n" + own_host + own_origin + "Upgrade: websocket\r\nConnection: Upgrade\r\n\r\n"},
      {"403", "GET /?token=TOKEN HTTP/1.1\r\n" + own_host + "Origin: http://localhost:8080\r\nUpgrade: websocket\r\n" +
                  "Connection: Upgrade\r\n\r\n"}};
  PageServer server;
  for (const auto& [status, bytes] : requests)
    EXPECT_THAT(server.answer_to(bytes), StartsWith("HTTP/1.1 " + status)) << bytes;
  EXPECT_EQ(server.asked_for(), 0);
  EXPECT_TRUE(server.answer_to(post(own_host + own_origin + with_token, "on")).ends_with("post on"))
      << "it must serve on";
}

TEST(Pages, AContentThatNeverComesEndsItsConnectionAlone) {
  PageServer server;
  EXPECT_EQ(server.answer_to("POST /echo HTTP/1.1\r\n" + own_host + with_token + "Content-Length: 100\r\n\r\n{"), "");
  EXPECT_EQ(server.asked_for(), 0);
  EXPECT_TRUE(server.answer_to(post(own_host + with_token, "on")).ends_with("post on"));
}

TEST(Pages, ThePageConnectsByWebSocketWithTheTokenInTheAddress) {
  const std::string upgrade =
      "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
  PageServer server;
  EXPECT_THAT(server.answer_to("GET /?token=TOKEN HTTP/1.1\r\n" + own_host + own_origin + upgrade, 500),
              testing::AllOf(StartsWith("HTTP/1.1 101"), HasSubstr("hello")));
  EXPECT_THAT(server.answer_to("GET / HTTP/1.1\r\n" + own_host + own_origin + upgrade, 500), Not(HasSubstr("hello")));
}

}  // namespace
}  // namespace rehearse::test
