#include "io_body.h"

#include "cnoid_body.h"

namespace rehearse {

IoBody::IoBody(const ScenarioBody& description, const BodyObservation& initial)
    : description_(description),
      body_(make_cnoid_body(model(), description.name, description.fixed)),
      enabled_(model().devices.size(), false),
      notified_(model().devices.size(), false) {
  set_initial_state(*body_, initial);
  for (int i = 0; i < body_->numDevices(); ++i) {
    connections_.emplace_back(body_->device(i)->sigStateChanged().connect([this, i] {
      notified_[i] = true;
      any_notified_ = true;
    }));
  }
}

void IoBody::input_devices(const BodyObservation& seen, double delivered_at) {
  for (std::size_t i = 0; i < enabled_.size(); ++i) {
    if (!enabled_[i] || !seen.devices[i].fresh) continue;
    cnoid::Device& device = *body_->device(static_cast<int>(i));
    feed_device(device, model().devices[i], seen.devices[i], delivered_at);
    connections_[i].block();  // what comes in is not sent out again
    device.notifyStateChange();
    connections_[i].unblock();
  }
}

std::vector<DeviceOutput> IoBody::take_device_outputs() {
  std::vector<DeviceOutput> outputs;
  if (!any_notified_) return outputs;
  for (std::size_t i = 0; i < notified_.size(); ++i) {
    if (!notified_[i]) continue;
    const cnoid::Device& device = *body_->device(static_cast<int>(i));
    DeviceOutput& output = outputs.emplace_back();
    output.device = static_cast<int>(i);
    output.on = device.on();
    output.values.resize(device.stateSize());
    device.writeState(output.values.data());
    notified_[i] = false;
  }
  any_notified_ = false;
  return outputs;
}

}  // namespace rehearse
