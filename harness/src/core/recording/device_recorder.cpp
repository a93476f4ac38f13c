#include "device_recorder.h"

#include <cmath>
#include <utility>

namespace rehearse {
namespace {

msg::Time time_of_capture(const DeviceReading& reading) {
  return msg::Time::from_ns(static_cast<std::uint64_t>(std::llround(reading.measured_at * 1e9)));
}

/// False: the reading has no message of this kind.
bool encode(const ChannelForm& form, const Device& device, const DeviceReading& reading, const msg::Header& header,
            DeviceMessage& message) {
  if (form.measurement->encode) return form.measurement->encode(device, reading, header, message);
  form.numbers->encode(header, reading.values, message.cdr);
  return true;
}

std::optional<FixedMessage> message_of_values(const ChannelForm& form, const Device& device, const std::string& frame) {
  if (value_count(device) == 0 || form.measurement->has_capture_time) return std::nullopt;
  return FixedMessage::of(static_cast<std::size_t>(value_count(device)),
                          [&](const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr) {
                            DeviceReading reading;
                            reading.values.assign(numbers.begin(), numbers.end());
                            DeviceMessage message;
                            encode(form, device, reading, {stamp, frame}, message);
                            cdr = std::move(message.cdr);
                          });
}

}  // namespace

DeviceRecorder::DeviceRecorder(TraceOutput& output, const Scenario& scenario, const ScenarioBody& body,
                               const Device& device)
    : device_(&device), frame_(frame_of(body.name, device)) {
  for (const ChannelKind kind : kinds_of(device)) {
    const ChannelForm& form = form_of(kind);
    const bool is_drawn = form.stage == Stage::renderer;
    if (is_drawn && (!scenario.record_frames || !scenario.runs_camera(body.name, device.name))) continue;
    channels_.push_back({output.channel(ChannelName::of_owner(body.name, device.name, kind)), &form,
                         message_of_values(form, device, frame_)});
  }
}

void DeviceRecorder::declare_truth(TraceOutput& output, const ScenarioBody& body) {
  mcap::StringMap metadata;
  for (const ChannelElement& element : value_elements(*device_)) {
    std::string& elements = metadata["elements"];
    elements += (elements.empty() ? "" : " ") + element.name;
    if (!element.unit.empty()) metadata["unit:" + element.name] = element.unit;
  }
  truth_ = output.channel<msg::DeviceState>(ChannelName::of_owner(body.name, device_->name, ChannelKind::truth),
                                            std::move(metadata));
}

Result<void> DeviceRecorder::write_truth(TraceOutput& output, std::int64_t tick,
                                         const std::vector<double>& values) const {
  if (!truth_) return {};
  return output.write(*truth_, tick, msg::DeviceState{{output.stamp(tick), frame_}, values});
}

Result<void> DeviceRecorder::write(TraceOutput& output, std::int64_t tick, const DeviceReading& reading) {
  for (Channel& channel : channels_) {
    if (channel.values && channel.values->size() == reading.values.size()) {
      channel.values->set(reading.values);
      REHEARSE_TRY(output.write(channel.id, tick, *channel.values));
      continue;
    }
    const bool at_capture = channel.form->measurement->has_capture_time;
    const msg::Header header{at_capture ? time_of_capture(reading) : output.stamp(tick), frame_};
    DeviceMessage& message = output.device_message;
    message.cdr.reset();
    message.compose = nullptr;
    if (!encode(*channel.form, *device_, reading, header, message)) continue;
    const bool is_color = channel.form->type == msg::CompressedImage::type_name && reading.image;
    if (is_color || channel.form->type == msg::Image::type_name) ++output.size.pictures;
    auto done = message.compose
                    ? output.write_later(channel.id, tick, message.held, std::move(message.raw), message.compose)
                    : output.write_encoded(channel.id, tick, message.cdr.bytes());
    if (!done) return done;
  }
  return {};
}

}  // namespace rehearse
