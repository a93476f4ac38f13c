#include "web_server.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <map>
#include <utility>

#include "port_owner.h"

namespace rehearse {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = boost::system::error_code;
using Socket = asio::basic_stream_socket<Tcp, asio::io_context::executor_type>;
using Stream = beast::basic_stream<Tcp, asio::io_context::executor_type>;
using Head = http::request<http::empty_body>;
using BodyParser = http::request_parser<http::string_body>;

std::string_view view(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// The number of header fields of that name.
std::ptrdiff_t count_of(const Head& head, http::field name) {
  const auto [first, last] = head.equal_range(name);
  return std::distance(first, last);
}

/// Compares in a time that doesn't depend on the place of a difference.
bool is_equal_secret(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

/// The value of `token` in an address as /?token=...; empty: it has none.
std::string_view token_of(std::string_view target) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view rest = target.substr(question + 1);
  constexpr std::string_view key = "token=";
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    if (pair.starts_with(key)) return pair.substr(key.size());
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
  }
  return {};
}

/// The token of a request by HTTP; empty: it has none.
std::string_view bearer_of(const Head& head) {
  constexpr std::string_view scheme = "Bearer ";
  const std::string_view field = view(head[http::field::authorization]);
  return field.starts_with(scheme) ? field.substr(scheme.size()) : std::string_view();
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

/// The page may run its own script, show pictures and frames that it has made, and connect to its server alone.
constexpr const char* page_policy =
    "default-src 'none'; script-src 'unsafe-inline' blob: data:; style-src 'unsafe-inline'; img-src data: blob:; "
    "font-src data:; connect-src 'self' data: blob:; frame-src blob:; worker-src blob: data:; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

/// The host of an origin as https://HOST:PORT, without its port; empty: it is no such origin.
std::string_view host_of_origin(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (!origin.starts_with(scheme)) continue;
    std::string_view host = origin.substr(scheme.size());
    const std::size_t colon = host.rfind(':');
    if (colon != std::string_view::npos && host.find_first_not_of("0123456789", colon + 1) == std::string_view::npos)
      host = host.substr(0, colon);
    return host;
  }
  return {};
}

bool is_this_machine(std::string_view host) { return host == "localhost" || host == "127.0.0.1" || host == "[::1]"; }

/// The words of a list as "a, b".
std::vector<std::string_view> words_of(std::string_view list) {
  std::vector<std::string_view> words;
  while (!list.empty()) {
    std::string_view word = list.substr(0, list.find(','));
    list.remove_prefix(std::min(word.size() + 1, list.size()));
    while (word.starts_with(' ') || word.starts_with('\t')) word.remove_prefix(1);
    while (word.ends_with(' ') || word.ends_with('\t')) word.remove_suffix(1);
    if (!word.empty()) words.push_back(word);
  }
  return words;
}

/// A stranger's text for a terminal: its printable ASCII, at most 80 characters.
std::string printable(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, 80)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown;
}

struct Refusal {
  http::status status;
  std::string reason;
};

const Refusal content_is_too_long{http::status::payload_too_large, "its content is too long"};

struct Frame {
  bool is_text = false;
  std::string beginning;
  WebServer::Body rest;

  std::size_t size() const { return beginning.size() + (rest ? rest->size() : 0); }
};

}  // namespace

Result<std::string> new_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return error("the system has no random bytes for a token");
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

struct WebServer::Impl {
  Impl(Options all_options, Handler& all_handler) : options(std::move(all_options)), handler(all_handler) {}

  Options options;
  Handler& handler;
  asio::io_context io{1};
  asio::basic_socket_acceptor<Tcp, asio::io_context::executor_type> acceptor{io.get_executor()};
  asio::basic_waitable_timer<std::chrono::steady_clock, asio::wait_traits<std::chrono::steady_clock>,
                             asio::io_context::executor_type>
      pause{io.get_executor()};
  std::map<Client, std::shared_ptr<Connection>> connections;
  Client last = 0;
  std::uint16_t port = 0;

  void accept();
  std::optional<Refusal> refusal(const Head& head) const;
  std::optional<Refusal> refusal_of_stranger(const Head& head) const;
  std::optional<Refusal> refusal_of_request(const Head& head) const;
  /// True if the address / is asked for, which needs no token.
  bool asks_for_page(const Head& head) const;
  /// The best subprotocol that the client offers; empty: none.
  std::string protocol_for(const Head& head) const;
};

class WebServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl& server, Client number, Socket socket)
      : server_(server), number_(number), stream_(std::move(socket)), buffer_(server.options.longest_request + 4096) {}

  void start() {
    head_.header_limit(8192);
    head_.body_limit(server_.options.longest_request);
    tcp().expires_after(server_.options.handshake_limit);
    http::async_read_header(stream_.next_layer(), buffer_, head_,
                            [self = shared_from_this()](Error failed, std::size_t) { self->took_head(failed); });
  }

  bool is_open() const { return open_; }
  std::size_t waiting() const { return waiting_; }

  bool send(Frame frame, std::size_t most) {
    if (!open_) return false;
    if (!queue_.empty() && waiting_ + frame.size() > most) return false;
    waiting_ += frame.size();
    queue_.push_back(std::move(frame));
    if (queue_.size() == 1) write();
    return true;
  }

  /// Ends the connection at once.
  void drop() {
    Error ignored;
    tcp().socket().close(ignored);
    finish();
  }

  /// Says goodbye, if nothing else is being written.
  void say_goodbye() {
    if (!open_ || !queue_.empty()) return drop();
    stream_.async_close(websocket::close_code::going_away, [self = shared_from_this()](Error) { self->finish(); });
  }

 private:
  Stream& tcp() { return stream_.next_layer(); }

  void took_head(Error failed) {
    if (failed) {
      if (failed == http::error::header_limit)
        return refuse({http::status::request_header_fields_too_large, "its head is too long"});
      if (failed == http::error::body_limit) return refuse(content_is_too_long);
      if (failed.category() == http::make_error_code(http::error::bad_method).category() &&
          failed != http::error::end_of_stream && failed != http::error::partial_message)
        return refuse({http::status::bad_request, "it is no HTTP"});
      return drop();
    }
    const Head& head = head_.get();
    if (auto refused = server_.refusal(head)) return refuse(*std::move(refused));
    if (!websocket::is_upgrade(head)) return take_request();
    if (buffer_.size() > 0) return refuse({http::status::bad_request, "bytes follow it before its answer"});
    tcp().expires_never();
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = server_.options.handshake_limit;
    limits.idle_timeout = server_.options.silence_limit;
    limits.keep_alive_pings = true;
    stream_.set_option(limits);
    protocol_ = server_.protocol_for(head);
    stream_.set_option(websocket::stream_base::decorator([protocol = protocol_](websocket::response_type& answer) {
      answer.set(http::field::server, "rehearse");
      if (!protocol.empty()) answer.set(http::field::sec_websocket_protocol, protocol);
    }));
    stream_.read_message_max(server_.options.longest_request);
    stream_.auto_fragment(false);
    stream_.async_accept(head, [self = shared_from_this()](Error problem) { self->accepted(problem); });
  }

  /// Reads the body of a request, which follows its head.
  void take_request() {
    request_.emplace(std::move(head_));
    request_->body_limit(server_.options.longest_request);
    http::async_read(stream_.next_layer(), buffer_, *request_,
                     [self = shared_from_this()](Error failed, std::size_t) { self->took_request(failed); });
  }

  void took_request(Error failed) {
    if (failed == http::error::body_limit) return refuse(content_is_too_long);
    if (failed) return drop();
    const auto& message = request_->get();
    const std::string_view path = path_of(view(message.target()));
    if (server_.asks_for_page(Head(message.base())))
      return answer({200, "text/html; charset=utf-8", server_.options.page});
    const bool is_post = message.method() == http::verb::post;
    if (auto answered = server_.handler.asked({is_post, path, message.body()})) return answer(*std::move(answered));
    refuse({http::status::not_found, "there is no such page"});
  }

  void refuse(Refusal refusal) {
    server_.handler.refused(refusal.reason);
    if (refusal.status == http::status::upgrade_required) answer_.set(http::field::upgrade, "websocket");
    answer({static_cast<unsigned>(refusal.status), "text/plain; charset=utf-8", "refused: " + refusal.reason + "\n"});
  }

  void answer(Answer answer) {
    answer_.version(11);
    answer_.result(answer.status);
    answer_.keep_alive(false);
    answer_.set(http::field::server, "rehearse");
    answer_.set(http::field::content_type, answer.type);
    answer_.set(http::field::cache_control, "no-store");
    answer_.set("X-Content-Type-Options", "nosniff");
    answer_.set("Referrer-Policy", "no-referrer");
    answer_.set("Content-Security-Policy", page_policy);
    answer_.body() = std::move(answer.body);
    answer_.prepare_payload();
    tcp().expires_after(server_.options.handshake_limit);
    http::async_write(stream_.next_layer(), answer_, [self = shared_from_this()](Error, std::size_t) { self->drop(); });
  }

  void accepted(Error failed) {
    if (failed) {
      server_.handler.refused("its handshake is no handshake of WebSocket");
      return drop();
    }
    open_ = true;
    server_.handler.opened(number_, protocol_);
    read();
  }

  void read() {
    if (!open_) return;
    stream_.async_read(buffer_, [self = shared_from_this()](Error failed, std::size_t) { self->took(failed); });
  }

  void took(Error failed) {
    if (failed) return drop();
    const auto bytes = buffer_.data();
    const auto* begin = static_cast<const std::byte*>(bytes.data());
    if (stream_.got_text())
      server_.handler.took_text(number_, {reinterpret_cast<const char*>(begin), bytes.size()});
    else
      server_.handler.took_bytes(number_, {begin, bytes.size()});
    buffer_.consume(buffer_.size());
    read();
  }

  void write() {
    const Frame& frame = queue_.front();
    const std::array<asio::const_buffer, 2> parts{
        asio::const_buffer(frame.beginning.data(), frame.beginning.size()),
        frame.rest ? asio::const_buffer(frame.rest->data(), frame.rest->size()) : asio::const_buffer()};
    stream_.text(frame.is_text);
    stream_.async_write(parts, [self = shared_from_this()](Error failed, std::size_t) { self->wrote(failed); });
  }

  void wrote(Error failed) {
    if (failed || !open_) return drop();
    waiting_ -= queue_.front().size();
    queue_.pop_front();
    if (!queue_.empty()) write();
  }

  void finish() {
    if (std::exchange(finished_, true)) return;
    const auto self = shared_from_this();
    server_.connections.erase(number_);
    if (std::exchange(open_, false)) server_.handler.closed(number_);
  }

  Impl& server_;
  const Client number_;
  websocket::stream<Stream> stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> head_;
  std::optional<BodyParser> request_;
  http::response<http::string_body> answer_;
  std::string protocol_;
  std::deque<Frame> queue_;  // the first is being written
  std::size_t waiting_ = 0;  // [bytes]
  bool open_ = false, finished_ = false;
};

void WebServer::Impl::accept() {
  acceptor.async_accept([this](Error failed, Socket socket) {
    if (failed == asio::error::operation_aborted) return;
    if (failed) {  // as without free descriptors
      pause.expires_after(std::chrono::milliseconds(100));
      pause.async_wait([this](Error stopped) {
        if (!stopped) accept();
      });
      return;
    }
    if (connections.size() < options.most_clients) {
      Error ignored;
      socket.set_option(Tcp::no_delay(true), ignored);
      const Client number = ++last;
      connections[number] = std::make_shared<Connection>(*this, number, std::move(socket));
      connections[number]->start();
    } else {
      handler.refused(fmt::format("{} clients are connected already", options.most_clients));
    }
    accept();
  });
}

std::string WebServer::Impl::protocol_for(const Head& head) const {
  const auto [first, last_field] = head.equal_range(http::field::sec_websocket_protocol);
  for (const std::string& mine : options.protocols)
    for (auto field = first; field != last_field; ++field)
      if (std::ranges::count(words_of(view(field->value())), std::string_view(mine)) > 0) return mine;
  return "";
}

std::optional<Refusal> WebServer::Impl::refusal_of_stranger(const Head& head) const {
  using http::status;
  if (count_of(head, http::field::host) != 1) return Refusal{status::bad_request, "it doesn't have one Host"};
  const std::string_view host = view(head[http::field::host]);
  const std::string suffix = fmt::format(":{}", port);
  if (!host.ends_with(suffix) || !is_this_machine(host.substr(0, host.size() - suffix.size())))
    return Refusal{status::forbidden, "its Host is not this server"};
  if (count_of(head, http::field::origin) > 1) return Refusal{status::bad_request, "it has several Origins"};
  const std::string_view origin = view(head[http::field::origin]);
  if (origin.empty() || std::ranges::count(options.origins, origin) > 0) return std::nullopt;
  const bool may_connect =
      options.page.empty() ? is_this_machine(host_of_origin(origin)) : origin == fmt::format("http://{}", host);
  if (may_connect) return std::nullopt;
  return Refusal{status::forbidden, fmt::format("pages of {} may not connect", printable(origin))};
}

std::optional<Refusal> WebServer::Impl::refusal_of_request(const Head& head) const {
  using http::status;
  if (asks_for_page(head)) return std::nullopt;
  if (!is_equal_secret(bearer_of(head), options.token)) return Refusal{status::forbidden, "it lacks the token"};
  if (head.method() != http::verb::get && head.method() != http::verb::post)
    return Refusal{status::method_not_allowed, "it is neither GET nor POST"};
  return std::nullopt;
}

bool WebServer::Impl::asks_for_page(const Head& head) const {
  return !options.page.empty() && head.method() == http::verb::get && path_of(view(head.target())) == "/";
}

std::optional<Refusal> WebServer::Impl::refusal(const Head& head) const {
  using http::status;
  if (auto stranger = refusal_of_stranger(head)) return stranger;
  if (!options.page.empty() && !websocket::is_upgrade(head)) return refusal_of_request(head);
  if (!options.token.empty() && !is_equal_secret(token_of(view(head.target())), options.token))
    return Refusal{status::forbidden, "its address lacks the token"};
  if (head.method() != http::verb::get) return Refusal{status::method_not_allowed, "it is no GET"};
  if (path_of(view(head.target())) != "/") return Refusal{status::not_found, "there is no such page"};
  if (head.find(http::field::content_length) != head.end() || head.find(http::field::transfer_encoding) != head.end())
    return Refusal{status::bad_request, "a GET has no content"};
  if (!websocket::is_upgrade(head)) return Refusal{status::upgrade_required, "a viewer connects by WebSocket"};
  if (!options.protocols.empty() && protocol_for(head).empty())
    return Refusal{status::bad_request,
                   fmt::format("it speaks none of the subprotocols {}", fmt::join(options.protocols, ", "))};
  return std::nullopt;
}

WebServer::WebServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

WebServer::~WebServer() { stop(); }

Result<std::unique_ptr<WebServer>> WebServer::listen(Options options, Handler& handler) {
  REHEARSE_ASSERT(options.page.empty() || !options.token.empty(), "who may ask for a page's data is known by a token");
  const std::uint16_t port = options.port;
  auto impl = std::make_unique<Impl>(std::move(options), handler);
  const Tcp::endpoint place(asio::ip::address_v4::loopback(), port);
  Error failed;
  impl->acceptor.open(place.protocol(), failed);
  if (!failed) impl->acceptor.set_option(asio::socket_base::reuse_address(true), failed);
  if (!failed) impl->acceptor.bind(place, failed);
  if (!failed) impl->acceptor.listen(16, failed);
  if (failed == asio::error::address_in_use)
    return error(fmt::format("{} has the port {}", owner_of_port(port), port), "name another one, or 0 for any");
  if (failed) return error(fmt::format("can't listen on port {}: {}", port, failed.message()));
  impl->port = impl->acceptor.local_endpoint(failed).port();
  impl->accept();
  return std::unique_ptr<WebServer>(new WebServer(std::move(impl)));
}

std::uint16_t WebServer::port() const { return impl_->port; }

void WebServer::send_text(Client client, std::string text) {
  const auto found = impl_->connections.find(client);
  if (found == impl_->connections.end() || !found->second->is_open()) return;
  const auto connection = found->second;
  // a text may take twice the room: messages leave it some
  if (!connection->send({true, std::move(text), nullptr}, 2 * impl_->options.most_waiting)) connection->drop();
}

bool WebServer::send_bytes(Client client, std::string beginning, Body rest) {
  const auto found = impl_->connections.find(client);
  return found != impl_->connections.end() &&
         found->second->send({false, std::move(beginning), std::move(rest)}, impl_->options.most_waiting);
}

std::size_t WebServer::waiting(Client client) const {
  const auto found = impl_->connections.find(client);
  return found == impl_->connections.end() ? 0 : found->second->waiting();
}

void WebServer::run_for(std::chrono::milliseconds time) {
  impl_->io.restart();
  impl_->io.run_for(time);
}

void WebServer::stop() {
  Error ignored;
  impl_->acceptor.close(ignored);
  impl_->pause.cancel(ignored);
  const auto waits = [](const auto& one) { return one.second->waiting() > 0; };
  for (int rounds = 0; rounds < 20 && std::ranges::any_of(impl_->connections, waits); ++rounds)
    run_for(std::chrono::milliseconds(50));  // a viewer that takes nothing delays the end by a second at most
  const auto all = impl_->connections;
  for (const auto& [number, connection] : all) connection->say_goodbye();
  if (!all.empty()) run_for(std::chrono::milliseconds(200));
  const auto left = impl_->connections;
  for (const auto& [number, connection] : left) connection->drop();
  run_for(std::chrono::milliseconds(0));
}

}  // namespace rehearse
