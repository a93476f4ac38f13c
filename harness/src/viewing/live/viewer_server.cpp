#include "viewer_server.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>
#include <variant>

namespace rehearse {

using viewer_protocol::Level;

namespace {

/// The text in the form of a part of an address.
std::string percent_encoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-';
    encoded += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return encoded;
}

WebServer::Body copy_of(std::span<const std::byte> data) {
  return std::make_shared<const std::vector<std::byte>>(data.begin(), data.end());
}

}  // namespace

ViewerServer::~ViewerServer() = default;

Result<std::unique_ptr<ViewerServer>> ViewerServer::listen(Options options, Content content) {
  std::unique_ptr<ViewerServer> server(new ViewerServer(std::move(options), std::move(content)));
  server->token_ = REHEARSE_TRY(new_token());
  server->content_.info.session = REHEARSE_TRY(new_token());
  WebServer::Options web;
  web.port = server->options_.port;
  web.token = server->token_;
  web.protocols.assign(std::begin(viewer_protocol::subprotocols), std::end(viewer_protocol::subprotocols));
  web.origins = server->options_.origins;
  web.origins.emplace_back("https://app.foxglove.dev");
  web.origins.emplace_back("file://");  // of viewers that are programs of their own
  server->web_ = REHEARSE_TRY(WebServer::listen(std::move(web), *server));
  return server;
}

std::string ViewerServer::address() const { return fmt::format("ws://127.0.0.1:{}/?token={}", web_->port(), token_); }

std::string ViewerServer::link() const {
  return "https://app.foxglove.dev/~/view?ds=foxglove-websocket&ds.url=" + percent_encoded(address());
}

void ViewerServer::add_channel(viewer_protocol::Channel channel) {
  if (channels_.contains(channel.id)) return;
  unannounced_.push_back(channel);
  channels_[channel.id] = std::move(channel);
}

std::optional<std::uint32_t> ViewerServer::channel_of(std::string_view topic) const {
  for (const auto& [id, channel] : channels_)
    if (channel.topic == topic) return id;
  return std::nullopt;
}

std::uint32_t ViewerServer::channels_from(std::uint32_t first) const {
  return static_cast<std::uint32_t>(std::distance(channels_.lower_bound(first), channels_.end()));
}

void ViewerServer::set_lasting(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::byte> data) {
  lasting_[channel] = {time_ns, copy_of(data)};
}

void ViewerServer::send(Client client, Viewer& viewer, std::uint32_t subscription, std::uint64_t time_ns,
                        const WebServer::Body& data) {
  if (!web_->send_bytes(client, viewer_protocol::message_head(subscription, time_ns), data)) ++viewer.lost;
}

void ViewerServer::publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::byte> data) {
  if (!is_wanted(channel)) return;
  const WebServer::Body body = copy_of(data);
  for (auto& [client, viewer] : clients_)
    if (const auto found = viewer.subscriptions.find(channel); found != viewer.subscriptions.end())
      send(client, viewer, found->second, time_ns, body);
}

void ViewerServer::publish_to(Client client, std::uint32_t channel, std::uint64_t time_ns,
                              std::span<const std::byte> data) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  if (const auto to = found->second.subscriptions.find(channel); to != found->second.subscriptions.end())
    send(client, found->second, to->second, time_ns, copy_of(data));
}

void ViewerServer::publish_time(std::uint64_t time_ns) {
  for (const auto& [client, viewer] : clients_) web_->send_bytes(client, viewer_protocol::time(time_ns));
}

void ViewerServer::publish_state(viewer_protocol::PlaybackStatus status, std::uint64_t time_ns, float speed,
                                 const std::string& id) {
  for (const auto& [client, viewer] : clients_)
    if (viewer.controls) web_->send_bytes(client, viewer_protocol::playback_state(status, time_ns, speed, id));
}

void ViewerServer::publish_status(Level level, const std::string& message) {
  for (const auto& [client, viewer] : std::map(clients_))
    web_->send_text(client, viewer_protocol::status(level, message));
}

void ViewerServer::run_for(std::chrono::milliseconds time) {
  if (const auto added = std::exchange(unannounced_, {}); !added.empty())
    for (const auto& [client, viewer] : std::map(clients_)) web_->send_text(client, viewer_protocol::advertise(added));
  web_->run_for(time);
  tell_losses();
}

/// Tells viewers that lost messages how many these were, once they take messages again.
void ViewerServer::tell_losses() {
  std::vector<std::pair<Client, std::string>> texts;
  for (auto& [client, viewer] : clients_) {
    if (viewer.lost == viewer.told || web_->waiting(client) > 0) continue;
    texts.emplace_back(client, fmt::format("messages were left out, because this viewer takes them too slowly: {}",
                                           viewer.lost - viewer.told));
    viewer.told = viewer.lost;
  }
  for (const auto& [client, text] : texts) web_->send_text(client, viewer_protocol::status(Level::warning, text));
}

void ViewerServer::opened(Client client, std::string_view protocol) {
  asked_.came = true;
  if (clients_.empty()) asked_.first_came = true;
  clients_[client].controls = protocol == viewer_protocol::subprotocols[0];
  options_.tell("a viewer has connected");
  web_->send_text(client, viewer_protocol::server_info(content_.info));
  std::vector<viewer_protocol::Channel> all;
  for (const auto& [id, channel] : channels_) all.push_back(channel);
  web_->send_text(client, viewer_protocol::advertise(all));
}

void ViewerServer::closed(Client client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  for (const auto& [subscription, channel] : found->second.channels) want(channel, -1);
  asked_.subscribed.erase(client);
  const std::uint64_t lost = found->second.lost;
  clients_.erase(found);
  options_.tell(lost == 0 ? "a viewer has gone"
                          : fmt::format("a viewer has gone, which took messages too slowly: {} were left out", lost));
}

void ViewerServer::refused(const std::string& reason) {
  constexpr std::size_t most = 20;  // a stranger can't fill the terminal
  if (refusals_.size() < most && refusals_.insert(reason).second)
    options_.tell(fmt::format("refused a connection: {}", reason));
}

void ViewerServer::took_text(Client client, std::string_view text) { take(client, viewer_protocol::parse(text)); }

void ViewerServer::took_bytes(Client client, std::span<const std::byte> bytes) {
  take(client, viewer_protocol::parse(bytes));
}

void ViewerServer::take(Client client, const Result<viewer_protocol::Request>& request) {
  if (!clients_.contains(client)) return;
  if (!request) return web_->send_text(client, viewer_protocol::status(Level::error, request.errors()[0].message));
  std::visit([&](const auto& one) { take(client, one); }, *request);
}

void ViewerServer::want(std::uint32_t channel, int change) {
  int& count = wanted_[channel];
  const int before = std::exchange(count, count + change);
  if ((before == 0) != (count == 0)) ++version_;
  if (count == 0) wanted_.erase(channel);
}

void ViewerServer::take(Client client, const viewer_protocol::Subscribe& request) {
  for (const auto& [subscription, channel] : request.subscriptions) {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    Viewer& viewer = found->second;
    if (!channels_.contains(channel)) {
      web_->send_text(client, viewer_protocol::status(Level::error, fmt::format("there is no channel {}", channel)));
      continue;
    }
    if (viewer.channels.contains(subscription) || viewer.subscriptions.contains(channel)) {
      web_->send_text(client, viewer_protocol::status(Level::error,
                                                      fmt::format("channel {} or subscription {} is subscribed already",
                                                                  channel, subscription)));
      continue;
    }
    viewer.channels[subscription] = channel;
    viewer.subscriptions[channel] = subscription;
    want(channel, 1);
    if (const auto lasting = lasting_.find(channel); lasting != lasting_.end())
      send(client, viewer, subscription, lasting->second.time, lasting->second.data);
    else
      asked_.subscribed[client].insert(channel);
  }
}

void ViewerServer::take(Client client, const viewer_protocol::Unsubscribe& request) {
  for (const std::uint32_t subscription : request.subscriptions) {
    Viewer& viewer = clients_.at(client);
    const auto found = viewer.channels.find(subscription);
    if (found == viewer.channels.end()) continue;
    want(found->second, -1);
    viewer.subscriptions.erase(found->second);
    viewer.channels.erase(found);
  }
}

void ViewerServer::take(Client client, const viewer_protocol::GetParameters& request) {
  web_->send_text(client, viewer_protocol::parameter_values(content_.parameters, request.names, request.id));
}

void ViewerServer::take(Client client, const viewer_protocol::SetParameters& request) {
  web_->send_text(client,
                  viewer_protocol::status(Level::warning,
                                          "parameters are values of the scenario of this run: they can't be changed"));
  web_->send_text(client, viewer_protocol::parameter_values(content_.parameters, {}, request.id));
}

void ViewerServer::take(Client client, const viewer_protocol::Playback& request) {
  if (!content_.info.range) {
    web_->send_text(client, viewer_protocol::status(Level::error, "a run that goes on can't be played or sought"));
    return;
  }
  constexpr std::size_t most = 100;
  if (asked_.playback.size() < most) asked_.playback.push_back(request);
}

}  // namespace rehearse
