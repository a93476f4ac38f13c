// ViewerServer: offers channels to viewers, and sends messages to those that subscribe. Internal.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "viewer_protocol.h"
#include "web_server.h"

namespace rehearse {

class ViewerServer final : WebServer::Handler {
 public:
  using Client = WebServer::Client;

  struct Options {
    std::uint16_t port = 0;            // 0: any free port
    std::vector<std::string> origins;  // of pages that may connect, besides pages of this machine and Foxglove's
    std::function<void(const std::string&)> tell;  // gets a line for the terminal; never null
  };

  /// What a viewer is told at first.
  struct Content {
    viewer_protocol::ServerInfo info;  // without its session
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  };

  static Result<std::unique_ptr<ViewerServer>> listen(Options options, Content content);
  ~ViewerServer() override;

  /// As "ws://127.0.0.1:8765/?token=...".
  std::string address() const;
  /// The address of Foxglove in a browser that opens address().
  std::string link() const;

  /// Offers a channel to all viewers, also those to come, if there is none with its id.
  void add_channel(viewer_protocol::Channel channel);
  /// The channel with that topic, and the number of channels with ids from `first` on.
  std::optional<std::uint32_t> channel_of(std::string_view topic) const;
  std::uint32_t channels_from(std::uint32_t first) const;
  void set_parameters(nlohmann::ordered_json parameters) { content_.parameters = std::move(parameters); }
  /// A message that each subscriber gets at once.
  void set_lasting(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::byte> data);

  bool has_clients() const { return !clients_.empty(); }
  bool wants_any() const { return !wanted_.empty(); }
  bool is_wanted(std::uint32_t channel) const { return wanted_.contains(channel); }
  /// Changes when another channel is wanted, or one is no longer.
  std::uint64_t version_of_wanted() const { return version_; }

  /// Sends a message to all that subscribe to its channel.
  void publish(std::uint32_t channel, std::uint64_t time_ns, std::span<const std::byte> data);
  /// The same to one of them.
  void publish_to(Client client, std::uint32_t channel, std::uint64_t time_ns, std::span<const std::byte> data);
  void publish_time(std::uint64_t time_ns);
  void publish_state(viewer_protocol::PlaybackStatus status, std::uint64_t time_ns, float speed, const std::string& id);
  void publish_status(viewer_protocol::Level level, const std::string& message);

  /// What viewers have asked for since the last call.
  struct Asked {
    std::vector<viewer_protocol::Playback> playback;
    std::map<Client, std::set<std::uint32_t>> subscribed;  // channels without a lasting message
    bool came = false;                                     // a client came
    bool first_came = false;                               // a client came, and there was none
  };
  Asked take_asked() { return std::exchange(asked_, {}); }

  /// Serves for that time.
  void run_for(std::chrono::milliseconds time);
  void stop() { web_->stop(); }

 private:
  struct Viewer {
    std::map<std::uint32_t, std::uint32_t> channels;       // by the client's numbers
    std::map<std::uint32_t, std::uint32_t> subscriptions;  // the client's numbers, by channel
    bool controls = false;                                 // it knows messages about playback
    std::uint64_t lost = 0, told = 0;                      // messages
  };
  struct Lasting {
    std::uint64_t time = 0;  // [ns]
    WebServer::Body data;
  };

  ViewerServer(Options options, Content content) : options_(std::move(options)), content_(std::move(content)) {}

  void opened(Client client, std::string_view protocol) override;
  void took_text(Client client, std::string_view text) override;
  void took_bytes(Client client, std::span<const std::byte> bytes) override;
  void closed(Client client) override;
  void refused(const std::string& reason) override;

  void take(Client client, const Result<viewer_protocol::Request>& request);
  void take(Client client, const viewer_protocol::Subscribe& request);
  void take(Client client, const viewer_protocol::Unsubscribe& request);
  void take(Client client, const viewer_protocol::GetParameters& request);
  void take(Client client, const viewer_protocol::SetParameters& request);
  void take(Client, const viewer_protocol::SubscribeParameters&) {}
  void take(Client client, const viewer_protocol::Playback& request);
  void want(std::uint32_t channel, int change);
  void send(Client client, Viewer& viewer, std::uint32_t subscription, std::uint64_t time_ns,
            const WebServer::Body& data);
  void tell_losses();

  Options options_;
  Content content_;
  std::string token_;
  std::map<std::uint32_t, viewer_protocol::Channel> channels_;
  std::vector<viewer_protocol::Channel> unannounced_;  // of them, to those that are connected
  std::map<std::uint32_t, Lasting> lasting_;
  std::map<Client, Viewer> clients_;
  std::map<std::uint32_t, int> wanted_;  // number of subscriptions
  std::uint64_t version_ = 0;
  Asked asked_;
  std::set<std::string> refusals_;  // that were told
  std::unique_ptr<WebServer> web_;
};

}  // namespace rehearse
