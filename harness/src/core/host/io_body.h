// IoBody: the copy of a robot that a controller and its children share, with connected devices.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>
#include <cnoid/Body>
#include <cnoid/ValueTree>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cnoid_body.h"

namespace rehearse {

/// A command of a controller to a device by notifyStateChange(): the numbers of the device's writeState().
struct DeviceOutput {
  int device = 0;  // index into the model's devices
  bool on = true;
  std::vector<double> values;
  bool acted_in_initialize = false;  // it has acted already, and is only recorded
};

/// The info() of a device that a controller announced by notifyInfoChange(), as a separate copy.
struct DeviceInfo {
  int device = 0;  // index into the model's devices
  cnoid::MappingPtr info;
};

/// The info() of a device as one line of YAML in flow style: {grip: 0.5, names: [a, b]}; "{}" if there is none. Keys in
/// alphabetical order.
std::string text_of(const cnoid::ValueNode* node);

class IoBody {
 public:
  /// A body at rest in the state of `initial`.
  IoBody(const ScenarioBody& description, const BodyObservation& initial);
  IoBody(const IoBody&) = delete;
  IoBody& operator=(const IoBody&) = delete;

  cnoid::Body& body() { return *body_; }
  const ScenarioBody& description() const { return description_; }
  const Model& model() const { return *description_.model; }

  /// From now on readings of the device are copied into the body.
  void enable(const cnoid::Device& device) { enabled_[device.index()] = true; }
  /// True if there is a fresh reading of an enabled device.
  bool hears(const BodyObservation& seen) const;
  /// Copies fresh readings of the enabled devices and emits their sigStateChanged. `delivered_at` [s].
  void input_devices(const BodyObservation& seen, double delivered_at);
  /// The devices whose change was notified since the last call, in model order.
  std::vector<DeviceOutput> take_device_outputs();
  /// The infos whose change was notified since the last call, in model order.
  std::vector<DeviceInfo> take_infos();
  /// Copies the info into an enabled device, and emits sigInfoChanged.
  void input_info(const DeviceInfo& changed);

 private:
  const ScenarioBody& description_;  // the scenario outlives the run
  cnoid::BodyPtr body_;
  std::vector<FeedFunction> feeds_;        // by device index
  std::vector<bool> enabled_;              // by device index
  std::vector<bool> notified_;             // by device index
  std::vector<bool> new_info_;             // by device index
  std::vector<std::vector<double>> said_;  // by device index: the last state sent to the device, which may come back
  bool any_notified_ = false;
  std::vector<cnoid::ScopedConnection> connections_;       // by device index: of states
  std::vector<cnoid::ScopedConnection> info_connections_;  // by device index
};

}  // namespace rehearse
