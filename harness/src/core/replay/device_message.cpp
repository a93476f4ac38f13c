#include "device_message.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <cmath>

#include "base/clock.h"

namespace rehearse {
namespace {

Result<bool> decode(const ChannelForm& form, const Device& device, mcap::Bytes message, DeviceReading& reading) {
  const DeviceMeasurement* measurement = form.measurement;
  if (!measurement || !measurement->is_of(device)) return false;
  if (measurement->decode) return measurement->decode(device, message, reading);
  return form.numbers && form.numbers->decode(message, reading.values);
}

}  // namespace

bool is_read_from(const Device& device, ChannelKind kind) {
  const ChannelForm& form = form_of(kind);
  return form.measurement && form.measurement->is_of(device) && (form.measurement->decode || form.numbers);
}

Result<void> read_device(const Device& device, ChannelKind kind, const mcap::Message& message, double time_step,
                         DeviceReading& reading) {
  msg::Header header;  // every measurement begins with it
  CdrReader reader(message.data);
  const Result<bool> read =
      msg::decode(reader, header) ? decode(form_of(kind), device, message.data, reading) : Result<bool>(false);
  if (!read)
    return error(fmt::format("the picture on {} at {} ns can't be replayed: {}", message.channel->topic,
                             message.log_time, read.errors()[0].message),
                 read.errors()[0].hint);
  if (!*read)
    return error(fmt::format("a message on {} at {} ns is not a measurement of device '{}'", message.channel->topic,
                             message.log_time, device.name));
  const double seconds = static_cast<double>(header.stamp.to_ns()) * 1e-9;
  reading.measured_at = time_of(std::llround(seconds / time_step), time_step);  // bit for bit the recorded number
  return {};
}

}  // namespace rehearse
