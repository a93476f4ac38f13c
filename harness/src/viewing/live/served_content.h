// ServedContent: the channels and parameters of a recording for viewers, and its messages in their form. Internal.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "viewer_server.h"
#include "viewing/export/viewer_form.h"

namespace rehearse {

class ServedContent final : ViewerForm::Sink {
 public:
  /// The log must outlive this.
  explicit ServedContent(const mcap::Reader& log);
  ServedContent(const ServedContent&) = delete;
  ServedContent& operator=(const ServedContent&) = delete;

  /// What viewers are told at first; without a range.
  ViewerServer::Content summary() const;
  /// Offers all channels that the server doesn't have. Lasting messages get that time [ns]. The server must outlive the
  /// calls below.
  void offer(ViewerServer& server, std::uint64_t start);

  /// The recording's channels of which a viewer wants messages.
  std::vector<std::uint16_t> wanted() const;
  /// The channel of the recording that makes the messages of a viewer's channel.
  std::uint16_t source_of(std::uint32_t channel) const;
  /// Sends a message, and those that are derived from it. `client`: to this one alone.
  void publish(const mcap::Message& message, std::optional<ViewerServer::Client> client = {});

  std::size_t channels() const { return log_.channels().size(); }  // of the log
  std::size_t topics() const { return log_.channels().size() + added_; }
  const Diagnostics& remarks() const { return remarks_; }

 private:
  std::uint32_t add_topic(const std::string& topic, std::string_view type, std::string schema) override;
  Result<void> put(std::uint32_t topic, std::uint64_t time_ns, mcap::Bytes data) override;

  const mcap::Reader& log_;
  std::optional<Scenario> scenario_;  // none: it is the log of another program
  std::optional<ViewerForm> form_;
  ViewerServer* server_ = nullptr;
  std::uint32_t added_ = 0;  // number of topics that the log lacks
  bool lasting_ = false;     // put() gets lasting messages
  std::optional<ViewerServer::Client> to_;
  Diagnostics remarks_;
};

}  // namespace rehearse
