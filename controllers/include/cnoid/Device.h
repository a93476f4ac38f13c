// Device: a sensor, light or other element fixed to a link. Its measurements or settings are its state.
//
// A controller has a separate copy of each device (see Body). Input: after enableInput(device) on the IO object the
// copy is refreshed before a control step whenever the simulated device has a new state. Output: change the copy, then
// call notifyStateChange(); without this call nothing is sent.
#pragma once

#include "ClonableReferenced.h"
#include "EigenTypes.h"
#include "Signal.h"
#include "ValueTree.h"

#include <string>

namespace cnoid {

class Body;
class Link;

/// The variable part of a device: copied between the controller's device and the simulated one, and recorded.
class CNOID_GENERAL_EXPORT DeviceState : public ClonableReferenced {
 public:
  ~DeviceState() override;

  /// The class's name, as in "ForceSensor".
  virtual const char* typeName() const = 0;

  /// Copies the state of a device of exactly the same type; throws std::invalid_argument for a different type. Images,
  /// points and ranges are shared, not copied.
  virtual void copyStateFrom(const DeviceState& other) = 0;

  /// A new copy; the caller becomes its first owner.
  virtual DeviceState* cloneState(DeviceState* existingClone = nullptr) const = 0;

  /// The number of doubles that writeState writes. They do not include images, points and ranges.
  virtual int stateSize() const = 0;

  /// Writes stateSize() doubles and returns a pointer behind the last one.
  virtual double* writeState(double* buffer) const = 0;

  /// Reads doubles in the form of writeState and returns a pointer behind the last one. If `size` (the number of
  /// available doubles) is less than stateSize(), reads nothing and returns `buffer`.
  virtual const double* readState(const double* buffer, int size) = 0;

 protected:
  DeviceState() = default;
  DeviceState(const DeviceState&) = default;
};

using DeviceStatePtr = ref_ptr<DeviceState>;

class CNOID_GENERAL_EXPORT Device : public DeviceState {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  ~Device() override;

  /// A new copy with name, id, place and state. It belongs to no body and has no slots connected.
  Device* clone() const { return static_cast<Device*>(doClone(nullptr)); }
  DeviceState* cloneState(DeviceState* existingClone = nullptr) const override;

  /// Position in Body::devices(); -1 outside a body.
  int index() const { return index_; }
  /// The id in the model; -1 if the model gives none.
  int id() const { return id_; }
  const std::string& name() const { return name_; }

  Link* link() { return link_; }
  const Link* link() const { return link_; }
  /// The body of the device's link, or null.
  Body* body();
  const Body* body() const;

  /// The pose of the device frame in the link frame.
  Isometry3& T_local() { return T_local_; }
  const Isometry3& T_local() const { return T_local_; }
  const Isometry3& localPosition() const { return T_local_; }
  Isometry3::LinearPart R_local() { return T_local_.linear(); }
  Isometry3::ConstLinearPart R_local() const { return T_local_.linear(); }
  Isometry3::ConstLinearPart localRotation() const { return T_local_.linear(); }
  Isometry3::TranslationPart p_local() { return T_local_.translation(); }
  Isometry3::ConstTranslationPart p_local() const { return T_local_.translation(); }
  Isometry3::ConstTranslationPart localTranslation() const { return T_local_.translation(); }

  template <class Scalar, int Mode, int Options>
  void setLocalPosition(const Eigen::Transform<Scalar, 3, Mode, Options>& pose) {
    T_local_ = pose.template cast<double>();
  }
  template <typename Derived>
  void setLocalRotation(const Eigen::MatrixBase<Derived>& rotation) {
    T_local_.linear() = rotation.template cast<double>();
  }
  template <typename Derived>
  void setLocalTranslation(const Eigen::MatrixBase<Derived>& translation) {
    T_local_.translation() = translation.template cast<double>();
  }

  /// True if the device is switched on. Devices without a switch are always on, and switching them has no effect.
  virtual bool on() const;
  virtual void on(bool on);

  /// Resets the state to that of a device without measurements: zeros, no image, no points. Lights have nothing to
  /// clear.
  virtual void clearState();

  /// Emitted by notifyTimeChange() alone: a run passes no times of devices.
  SignalProxy<void(double time)> sigTimeChanged() { return sigTimeChanged_; }
  void notifyTimeChange(double time) { sigTimeChanged_(time); }

  SignalProxy<void()> sigStateChanged() { return sigStateChanged_; }
  /// Marks the state as changed. On a controller's device: the whole state is sent to the simulation after control().
  void notifyStateChange() { sigStateChanged_(); }

  /// Named values in addition to the state: additional information in the model, and values on which a controller and a
  /// simulation agree. Never null. A copy of the device has separate values.
  Mapping* info() { return info_; }
  const Mapping* info() const { return info_; }
  void resetInfo(Mapping* info) { info_ = info; }
  SignalProxy<void()> sigInfoChanged() { return sigInfoChanged_; }
  /// Marks info() as changed: it is sent like the state after notifyStateChange().
  void notifyInfoChange() { sigInfoChanged_(); }

  [[deprecated("Use T_local.")]] const Isometry3& T_local_org() const { return T_local_; }
  [[deprecated("Use setLocalRotation.")]] void setLocalAttitude(const Isometry3& pose) {
    T_local_.linear() = pose.linear();
  }
  /// No effect: the rate of a vision sensor is its frame rate, and other sensors measure in every step. [ms]
  [[deprecated("Use VisionSensor::setFrameRate.")]] void setCycle(double) {}
  [[deprecated("Use VisionSensor::frameRate.")]] double cycle() const { return 20.0; }

  // For building a body
  void setIndex(int index) { index_ = index; }
  void setId(int id) { id_ = id; }
  void setName(const std::string& name) { name_ = name; }
  void setLink(Link* link) { link_ = link; }

 protected:
  Device();
  Device(const Device& other);
  Device& operator=(const Device&) = delete;

 private:
  int index_ = -1;
  int id_ = -1;
  Link* link_ = nullptr;
  std::string name_;
  Isometry3 T_local_;
  MappingPtr info_;
  Signal<void()> sigStateChanged_;
  Signal<void(double time)> sigTimeChanged_;
  Signal<void()> sigInfoChanged_;
};

using DevicePtr = ref_ptr<Device>;

}  // namespace cnoid
