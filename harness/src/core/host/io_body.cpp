#include "io_body.h"

#include <utility>

namespace rehearse {

std::string text_of(const cnoid::ValueNode* node) {
  if (!node || !node->isValid()) return "{}";
  if (node->isScalar()) return node->toString();
  std::string text;
  const auto separate = [&text] { text += text.empty() ? "" : ", "; };
  if (node->isListing()) {
    for (const auto& element : *node->toListing()) {
      separate();
      text += text_of(element);
    }
    return "[" + text + "]";
  }
  for (const auto& [key, value] : *node->toMapping()) {
    separate();
    text += key + ": " + text_of(value);
  }
  return "{" + text + "}";
}

IoBody::IoBody(const ScenarioBody& description, const BodyObservation& initial)
    : description_(description),
      body_(make_cnoid_body(model(), description.title.empty() ? description.name : description.title,
                            description.fixed)),
      enabled_(model().devices.size(), false),
      notified_(model().devices.size(), false),
      new_info_(model().devices.size(), false),
      said_(model().devices.size()) {
  set_initial_state(*body_, model(), initial);
  for (const Device& device : model().devices) feeds_.push_back(device_feed(device));
  for (int i = 0; i < body_->numDevices(); ++i) {
    connections_.emplace_back(body_->device(i)->sigStateChanged().connect([this, i] {
      notified_[i] = true;
      any_notified_ = true;
    }));
    info_connections_.emplace_back(body_->device(i)->sigInfoChanged().connect([this, i] { new_info_[i] = true; }));
  }
}

bool IoBody::hears(const BodyObservation& seen) const {
  for (std::size_t i = 0; i < enabled_.size(); ++i)
    if (enabled_[i] && seen.devices[i].fresh) return true;
  return false;
}

void IoBody::input_devices(const BodyObservation& seen, double delivered_at) {
  for (std::size_t i = 0; i < enabled_.size(); ++i) {
    if (!enabled_[i] || !seen.devices[i].fresh) continue;
    if (std::holds_alternative<Light>(model().devices[i].kind) && std::exchange(said_[i], {}) == seen.devices[i].values)
      continue;  // it sent the change itself
    cnoid::Device& device = *body_->device(static_cast<int>(i));
    feeds_[i](device, model().devices[i], seen.devices[i], delivered_at);
    connections_[i].block();  // incoming changes are not sent out again
    device.notifyStateChange();
    connections_[i].unblock();
  }
}

std::vector<DeviceOutput> IoBody::take_device_outputs() {
  std::vector<DeviceOutput> outputs;
  if (!std::exchange(any_notified_, false)) return outputs;
  for (std::size_t i = 0; i < notified_.size(); ++i) {
    if (!notified_[i]) continue;
    const cnoid::Device& device = *body_->device(static_cast<int>(i));
    DeviceOutput& output = outputs.emplace_back();
    output.device = static_cast<int>(i);
    output.on = device.on();
    output.values.resize(device.stateSize());
    device.writeState(output.values.data());
    said_[i] = output.values;
    notified_[i] = false;
  }
  return outputs;
}

std::vector<DeviceInfo> IoBody::take_infos() {
  std::vector<DeviceInfo> infos;
  for (std::size_t i = 0; i < new_info_.size(); ++i) {
    if (!new_info_[i]) continue;
    new_info_[i] = false;
    const int device = static_cast<int>(i);
    const cnoid::Mapping* info = body_->device(device)->info();
    infos.push_back({device, info ? info->deepClone() : new cnoid::Mapping});
  }
  return infos;
}

void IoBody::input_info(const DeviceInfo& changed) {
  if (!enabled_[changed.device]) return;
  cnoid::Device& device = *body_->device(changed.device);
  device.resetInfo(changed.info->deepClone());
  info_connections_[changed.device].block();  // incoming changes are not sent out again
  device.notifyInfoChange();
  info_connections_[changed.device].unblock();
}

}  // namespace rehearse
