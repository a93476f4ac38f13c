// WebServer: HTTP and WebSocket for viewers and one page on this machine, in one thread. Internal.
//
// It listens on the loopback interface alone. A handshake must have the token in its address, a Host that names this
// server, and no Origin of a stranger's page; so neither another user of the machine nor a page in a browser gets in.
// A request by HTTP has the token in its head, `Authorization: Bearer TOKEN`, where no other page can put it. Only the
// page itself needs no token: it has no content but the program's.
// Each client has a bounded queue: what doesn't fit is lost for this client, and no client delays another.
#pragma once

#include <rehearse/diagnostic.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
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
    std::string page;                    // HTML of the address /; only this page may connect then. Empty: there is none
    std::size_t most_clients = 16;
    std::size_t most_waiting = std::size_t{16} << 20;    // of a client's queue [bytes]
    std::size_t longest_request = std::size_t{1} << 16;  // a longer message ends its client [bytes]
    std::chrono::milliseconds handshake_limit{5000};     // for a whole handshake
    std::chrono::milliseconds silence_limit{60000};      // a client that answers no ping so long is dropped
  };

  /// A request by HTTP, with the token.
  struct Request {
    bool is_post = false;   // or else a GET
    std::string_view path;  // as /accept, without a query
    std::string_view body;  // of a POST
  };
  struct Answer {
    unsigned status = 200;
    std::string type = "application/json";
    std::string body = "{}";
  };

  class Handler {
   public:
    virtual ~Handler() = default;
    /// None: there is no such page. Called only with `Options::page`.
    virtual std::optional<Answer> asked(const Request& /*request*/) { return std::nullopt; }
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
