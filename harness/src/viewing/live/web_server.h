// WebServer: HTTP and WebSocket for viewers on this machine, in one thread. Internal.
//
// It listens on the loopback interface alone. A handshake must have the token in its address, a Host that names this
// server, and no Origin of a stranger's page; so neither another user of the machine nor a page in a browser gets in.
// Each client has a bounded queue: what doesn't fit is lost for this client, and no client delays another.
#pragma once

#include <rehearse/diagnostic.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// 128 bits that no other user can guess, as 32 hexadecimal digits. Fails without a source of random bytes.
Result<std::string> new_token();

class WebServer {
 public:
  using Client = std::uint64_t;  // counts from 1

  struct Options {
    std::uint16_t port = 0;              // 0: any free port
    std::string token;                   // empty: none is demanded
    std::vector<std::string> protocols;  // subprotocols of WebSocket, the best first
    std::vector<std::string> origins;    // of pages that may connect, besides pages of this machine
    std::size_t most_clients = 16;
    std::size_t most_waiting = std::size_t{16} << 20;    // of a client's queue [bytes]
    std::size_t longest_request = std::size_t{1} << 16;  // a longer message ends its client [bytes]
    std::chrono::milliseconds handshake_limit{5000};     // for a whole handshake
    std::chrono::milliseconds silence_limit{60000};      // a client that answers no ping so long is dropped
  };

  class Handler {
   public:
    virtual ~Handler() = default;
    virtual void opened(Client client, std::string_view protocol) = 0;
    virtual void took_text(Client client, std::string_view text) = 0;
    virtual void took_bytes(Client client, std::span<const std::byte> bytes) = 0;
    virtual void closed(Client client) = 0;
    /// A handshake was refused; the reason has no text of the stranger but his origin.
    virtual void refused(const std::string& reason) = 0;
  };

  /// A message that several clients get, each with its own beginning.
  using Body = std::shared_ptr<const std::vector<std::byte>>;

  /// Fails if the port is in use, and names the program that has it. `handler` must outlive the server.
  static Result<std::unique_ptr<WebServer>> listen(Options options, Handler& handler);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;

  /// Sends a text. A client whose queue has no room for it is closed: it could not go on without it.
  void send_text(Client client, std::string text);
  /// Sends bytes. False: the queue of the client has no room for them, and they are lost.
  bool send_bytes(Client client, std::string beginning, Body rest = nullptr);
  /// Bytes that the client hasn't taken yet.
  std::size_t waiting(Client client) const;

  /// Serves for that time.
  void run_for(std::chrono::milliseconds time);
  /// Ends all connections.
  void stop();

 private:
  class Connection;
  struct Impl;
  explicit WebServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
