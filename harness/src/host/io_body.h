// IoBody: the copy of a robot that a controller and its children share, with its devices wired up.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>
#include <cnoid/Body>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

/// What a controller said to a device by notifyStateChange(): the numbers of the device's writeState().
struct DeviceOutput {
  int device = 0;  // index into the model's devices
  bool on = true;
  std::vector<double> values;
  bool told = false;  // it has acted already, and is there for the record
};

/// What a controller put into the info() of a device and announced by notifyInfoChange(): a copy of its own.
struct DeviceInfo {
  int device = 0;  // index into the model's devices
  cnoid::MappingPtr info;
};

class IoBody {
 public:
  /// At rest in the state of `initial`.
  IoBody(const ScenarioBody& description, const BodyObservation& initial);
  IoBody(const IoBody&) = delete;
  IoBody& operator=(const IoBody&) = delete;

  cnoid::Body& body() { return *body_; }
  const ScenarioBody& description() const { return description_; }
  const Model& model() const { return *description_.model; }

  /// From now on readings of the device reach the body's copy.
  void enable(const cnoid::Device& device) { enabled_[device.index()] = true; }
  bool is_enabled(int device) const { return enabled_[device]; }
  /// Whether there is a fresh reading of an enabled device.
  bool hears(const BodyObservation& seen) const;
  /// Copies fresh readings of the enabled devices and emits their sigStateChanged. `delivered_at` [s].
  void input_devices(const BodyObservation& seen, double delivered_at);
  /// The devices whose change was notified since the last call, in model order.
  std::vector<DeviceOutput> take_device_outputs();
  /// The infos whose change was notified since the last call, in model order.
  std::vector<DeviceInfo> take_infos();
  /// An enabled device gets a copy of the info, and emits sigInfoChanged.
  void input_info(const DeviceInfo& changed);

 private:
  const ScenarioBody& description_;  // the scenario outlives the run
  cnoid::BodyPtr body_;
  std::vector<bool> enabled_;              // by device index
  std::vector<bool> notified_;             // by device index
  std::vector<bool> new_info_;             // by device index
  std::vector<std::vector<double>> said_;  // by device index: what was last sent out, and may come back
  bool any_notified_ = false;
  std::vector<cnoid::ScopedConnection> connections_;       // by device index: of states
  std::vector<cnoid::ScopedConnection> info_connections_;  // by device index
};

}  // namespace rehearse
