// A client of the tests, which writes bytes as they are, and a server for it.
#pragma once

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "viewing/live/viewer_server.h"

namespace rehearse::test {

/// A frame of WebSocket, as a client sends it, unless a part is changed.
struct WireFrame {
  int opcode = 1;
  std::string payload = {};
  bool is_last = true;
  bool is_masked = true;
  int reserved = 0;  // three bits
  int stated = -1;   // a size that isn't the payload's; -1: the payload's
  int width = 0;     // bytes of the size, 2 or 8, if they aren't the fewest

  std::string bytes() const {
    std::string out(1, static_cast<char>((is_last ? 0x80 : 0) | reserved << 4 | opcode));
    const auto size = stated < 0 ? payload.size() : static_cast<std::size_t>(stated);
    const int wide = width > 0 ? width : size < 126 ? 0 : size < 65536 ? 2 : 8;
    const int mark = is_masked ? 0x80 : 0;
    out += static_cast<char>(mark | (wide == 0 ? static_cast<int>(size) : wide == 2 ? 126 : 127));
    for (int i = wide - 1; i >= 0; --i) out += static_cast<char>(size >> (8 * i));
    const std::string mask = is_masked ? std::string("\x11\x22\x33\x44") : std::string();
    out += mask;
    for (std::size_t i = 0; i < payload.size(); ++i)
      out += is_masked ? static_cast<char>(payload[i] ^ mask[i % 4]) : payload[i];
    return out;
  }
};

class WireClient {
 public:
  explicit WireClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
  }
  ~WireClient() { ::close(socket_); }
  WireClient(const WireClient&) = delete;
  WireClient& operator=(const WireClient&) = delete;

  void send(const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;
      sent += static_cast<std::size_t>(count);
    }
  }
  void end_sending() { ::shutdown(socket_, SHUT_WR); }

  /// Receives until the text is there, the server has closed the connection, or the time is over.
  bool wait_for(const std::string& text, int milliseconds = 5000) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
    while (received_.find(text) == std::string::npos && !closed_) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd wait{socket_, POLLIN, 0};
      if (left.count() <= 0 || ::poll(&wait, 1, static_cast<int>(left.count())) <= 0) return false;
      char block[65536];
      const ssize_t count = ::recv(socket_, block, sizeof block, 0);
      if (count <= 0)
        closed_ = true;
      else
        received_.append(block, static_cast<std::size_t>(count));
    }
    return received_.find(text) != std::string::npos;
  }
  /// True if the server closes the connection in that time.
  bool wait_for_end(int milliseconds = 5000) {
    wait_for("\n\nno server sends this\n\n", milliseconds);
    return closed_;
  }
  const std::string& received() const { return received_; }
  void forget() { received_.clear(); }

 private:
  int socket_;
  std::string received_;
  bool closed_ = false;
};

/// A server with two channels, in a thread of its own.
class RunningServer {
 public:
  RunningServer() {
    ViewerServer::Content content;
    content.info.name = "test";
    content.info.range = {0, 1'000'000'000};
    content.parameters["time_step"] = 0.001;
    auto listening = ViewerServer::listen({0,
                                           {"https://viewer.example.com"},
                                           [this](const std::string& line) {
                                             const std::lock_guard lock(mutex_);
                                             told_.push_back(line);
                                           }},
                                          content);
    EXPECT_TRUE(listening) << to_string(listening.errors());
    server_ = *std::move(listening);
    server_->add_channel({1, "/numbers", "json", "Number", "jsonschema", "{}"});
    server_->add_channel({2, "/pictures", "json", "Picture", "jsonschema", "{}"});
    const std::string address = server_->address();
    const std::size_t colon = address.rfind(':'), slash = address.rfind('/');
    port_ = static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1, slash - colon - 1)));
    token_ = address.substr(address.find('=') + 1);
    thread_ = std::thread([this] {
      while (!stopped_) {
        server_->run_for(std::chrono::milliseconds(2));
        const std::lock_guard lock(mutex_);
        for (const auto& [channel, size] : std::exchange(to_publish_, {}))
          server_->publish(channel, 0, std::vector<std::byte>(size));
      }
    });
  }
  ~RunningServer() {
    stopped_ = true;
    thread_.join();
    server_->stop();
  }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  std::uint16_t port() const { return port_; }
  /// Replaces PORT and TOKEN.
  std::string filled(std::string text) const {
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"PORT", std::to_string(port_)}, {"TOKEN", token_}})
      for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos; at += value.size())
        text.replace(at, name.size(), value);
    return text;
  }
  std::string handshake() const {
    return filled(
        "GET /?token=TOKEN HTTP/1.1\r\nHost: 127.0.0.1:PORT\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n");
  }
  std::unique_ptr<WireClient> connected() const {
    auto client = std::make_unique<WireClient>(port_);
    client->send(handshake());
    EXPECT_TRUE(client->wait_for("advertise")) << client->received();
    return client;
  }
  void publish(std::uint32_t channel, std::size_t size) {
    const std::lock_guard lock(mutex_);
    to_publish_.emplace_back(channel, size);
  }
  bool was_told(const std::string& text) {
    const std::lock_guard lock(mutex_);
    for (const std::string& line : told_)
      if (line.find(text) != std::string::npos) return true;
    return false;
  }

 private:
  std::unique_ptr<ViewerServer> server_;
  std::uint16_t port_ = 0;
  std::string token_;
  std::mutex mutex_;
  std::vector<std::string> told_;
  std::vector<std::pair<std::uint32_t, std::size_t>> to_publish_;
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

inline std::string text_frame(const std::string& payload) { return WireFrame{.opcode = 1, .payload = payload}.bytes(); }

/// True if the server answers a request of this client.
inline bool is_served(WireClient& client) {
  client.forget();
  client.send(text_frame(R"({"op":"getParameters","parameterNames":[],"id":"alive"})"));
  return client.wait_for(R"("id":"alive")");
}

}  // namespace rehearse::test
