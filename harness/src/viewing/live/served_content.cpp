#include "served_content.h"

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

constexpr std::uint32_t first_added = 0x10000;  // ids of the log's channels have 16 bits

bool is_recording(const mcap::Reader& log) {
  return std::ranges::any_of(log.channels(), [](const auto& one) { return one.second.topic == run_topics::tick; });
}

nlohmann::ordered_json value_of(const std::string& text) {
  if (const auto number = number_in<double>(text)) return *number;
  return text;
}

}  // namespace

ServedContent::ServedContent(const mcap::Reader& log) : log_(log) {
  if (!is_recording(log)) return;
  auto scenario = scenario_of(log);
  if (scenario)
    scenario_ = *std::move(scenario);
  else
    remarks_ = scenario.errors();
  if (scenario_) form_.emplace(log_, *scenario_, static_cast<ViewerForm::Sink&>(*this), true);
}

ViewerServer::Content ServedContent::summary() const {
  ViewerServer::Content content;
  content.info.name = "rehearse " + log_.name();
  for (const mcap::Metadata& metadata : log_.metadata())
    if (metadata.name == records::provenance)
      for (const auto& [key, value] : metadata.values) content.parameters[key] = value_of(value);
  if (!scenario_) return content;
  for (const ScenarioBody& body : scenario_->bodies)
    for (const ScenarioController& controller : body.controllers) {
      const std::string prefix = body.name + "." + controller.name + ".";
      content.parameters[prefix + "library"] = controller.library;
      content.parameters[prefix + "options"] = controller.options;
      content.parameters[prefix + "delay"] = controller.delay;
    }
  return content;
}

void ServedContent::offer(ViewerServer& server, std::uint64_t start) {
  server_ = &server;
  for (const auto& [id, channel] : log_.channels()) {
    const mcap::Schema* schema = log_.schema_of(channel);
    server.add_channel({id, channel.topic, channel.message_encoding, schema ? schema->name : "",
                        schema ? schema->encoding : "", schema ? schema->data : ""});
  }
  if (!form_) return;
  lasting_ = true;
  static_cast<void>(form_->put_first(start));  // put() doesn't fail
  lasting_ = false;
  form_->add_topics();
  remarks_.insert(remarks_.end(), form_->remarks().begin(), form_->remarks().end());
}

std::uint32_t ServedContent::add_topic(const std::string& topic, std::string_view type, std::string schema) {
  ++added_;
  const std::uint32_t id = server_->channel_of(topic).value_or(first_added + server_->channels_from(first_added));
  server_->add_channel({id, topic, "cdr", std::string(type), "ros2msg", std::move(schema)});
  return id;
}

Result<void> ServedContent::put(std::uint32_t topic, std::uint64_t time_ns, mcap::Bytes data) {
  if (lasting_)
    server_->set_lasting(topic, time_ns, data);
  else if (to_)
    server_->publish_to(*to_, topic, time_ns, data);
  else
    server_->publish(topic, time_ns, data);
  return {};
}

std::vector<std::uint16_t> ServedContent::wanted() const {
  std::vector<std::uint16_t> ids;
  for (const auto& [id, channel] : log_.channels()) {
    const auto derived = form_ ? form_->derived_from(id) : std::nullopt;
    if (server_->is_wanted(id) || (derived && server_->is_wanted(*derived))) ids.push_back(id);
  }
  return ids;
}

std::uint16_t ServedContent::source_of(std::uint32_t channel) const {
  if (channel < first_added) return static_cast<std::uint16_t>(channel);
  for (const auto& [id, recorded] : log_.channels())
    if (form_ && form_->derived_from(id) == channel) return id;
  return 0;
}

void ServedContent::publish(const mcap::Message& message, std::optional<ViewerServer::Client> client) {
  const mcap::Bytes data = form_ ? form_->data_of(message) : message.data;
  if (client)
    server_->publish_to(*client, message.channel->id, message.log_time, data);
  else
    server_->publish(message.channel->id, message.log_time, data);
  if (!form_) return;
  to_ = client;
  static_cast<void>(form_->derive(message));  // put() doesn't fail
  to_.reset();
}

}  // namespace rehearse
