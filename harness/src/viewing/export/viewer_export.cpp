#include "viewer_export.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <map>
#include <memory>

#include "core/mcap/draft.h"
#include "core/scenario/trace_scenario.h"
#include "viewer_form.h"

namespace rehearse {
namespace {

class ViewerExport final : ViewerForm::Sink {
 public:
  ViewerExport(mcap::Reader& log, const Scenario& scenario, mcap::Writer& writer, const ViewerOptions& options)
      : log_(log), writer_(writer), form_(log, scenario, *this, options.contacts), options_(options) {}

  Result<ViewerReport> run();

 private:
  std::uint32_t add_topic(const std::string& topic, std::string_view type, std::string schema) override;
  Result<void> put(std::uint32_t topic, std::uint64_t time_ns, mcap::Bytes data) override;
  Result<void> copy_messages();

  mcap::Reader& log_;
  mcap::Writer& writer_;
  ViewerForm form_;
  const ViewerOptions& options_;
  ViewerReport report_;
};

std::uint32_t ViewerExport::add_topic(const std::string& topic, std::string_view type, std::string schema) {
  report_.topics.push_back(topic);
  return writer_.add_channel(writer_.add_schema(type, "ros2msg", schema), topic, "cdr", {{"offered_qos_profiles", ""}});
}

Result<void> ViewerExport::put(std::uint32_t topic, std::uint64_t time_ns, mcap::Bytes data) {
  ++report_.messages;
  return writer_.write(static_cast<std::uint16_t>(topic), time_ns, time_ns, data);
}

Result<void> ViewerExport::copy_messages() {
  std::map<std::uint16_t, std::uint16_t> ids;
  for (const auto& [id, channel] : log_.channels())
    ids[id] = writer_.add_channel(mcap::copy(log_.schema_of(channel), writer_), channel.topic, channel.message_encoding,
                                  channel.metadata, channel.topic.ends_with("/image") ? mcap::pictures : mcap::numbers);
  form_.add_topics();
  Result<void> written;
  const Result<void> read = log_.for_each_message_in_order([&](const mcap::Message& message) {
    ++report_.messages;
    written = writer_.write(ids[message.channel->id], message.log_time, message.publish_time, form_.data_of(message),
                            message.sequence);
    if (written) written = form_.derive(message);
    return written.ok();
  });
  return written ? read : written;
}

Result<ViewerReport> ViewerExport::run() {
  std::uint64_t start = 0;  // log time of the first message [ns]
  static_cast<void>(log_.for_each_message_in_order([&](const mcap::Message& message) {
    start = message.log_time;
    return false;
  }));
  for (const mcap::Attachment& attachment : log_.attachments()) REHEARSE_TRY(mcap::copy(attachment, writer_));
  for (const mcap::Metadata& metadata : log_.metadata())
    REHEARSE_TRY(writer_.add_metadata(metadata.name, metadata.values));
  REHEARSE_TRY(form_.put_first(start));
  REHEARSE_TRY(copy_messages());
  REHEARSE_TRY(writer_.close());
  report_.frames = form_.frames();
  report_.remarks = form_.remarks();
  if (options_.contacts && !form_.has_markers())
    report_.remarks.push_back(
        warning("there are no markers of contacts: the recording has no contact forces",
                "they are recorded for controllers that enable LinkContactState, and for contact sensors"));
  return report_;
}

}  // namespace

Result<ViewerReport> export_for_viewer(const std::filesystem::path& trace, const std::filesystem::path& file,
                                       const ViewerOptions& options) {
  const auto log = REHEARSE_TRY(mcap::Reader::open(trace));
  const auto scenario = REHEARSE_TRY(scenario_of(*log));
  auto draft = REHEARSE_TRY(mcap::Draft::begin(file, std::span(&trace, 1)));
  mcap::WriterOptions form;
  form.profile = log->profile();
  auto writer = REHEARSE_TRY(draft.open_writer(form));
  auto report = ViewerExport(*log, scenario, *writer, options).run();
  if (!report) return report;
  REHEARSE_TRY(draft.finish());
  return report;
}

}  // namespace rehearse
