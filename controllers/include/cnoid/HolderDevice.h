// HolderDevice: a gripper that, while on, holds objects that can be attached to it.
//
// Its state is on(); what holding does is the simulation's matter. In Rehearse's dynamics nothing is attached: a
// gripper holds by contact.
#pragma once

#include "Device.h"

#include <string>
#include <vector>

namespace cnoid {

class AttachmentDevice;

class CNOID_GENERAL_EXPORT HolderDevice : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  HolderDevice();
  ~HolderDevice() override;

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // on
  const double* readState(const double* buffer, int size) override;

  /// Off by default.
  bool on() const override;
  void on(bool on) override;

  /// Which attachments it can hold: those of a category it has; without any: all.
  const std::vector<std::string>& categories() const { return categories_; }
  bool hasCategories() const { return !categories_.empty(); }
  bool hasCategory(const std::string& category) const;
  /// An empty name is not added.
  void addCategory(const std::string& category);
  void clearCategories() { categories_.clear(); }

  /// What must hold for an object to be held: it is near, it is touched, it has the name.
  enum HoldCondition { Distance, Collision, Name };
  int holdCondition() const { return holdCondition_; }
  void setHoldCondition(int condition) { holdCondition_ = condition; }
  double maxHoldDistance() const { return maxHoldDistance_; }  // [m]
  void setMaxHoldDistance(double distance) { maxHoldDistance_ = distance; }
  const std::string& holdTargetName() const { return holdTargetName_; }
  void setHoldTargetName(const std::string& name) { holdTargetName_ = name; }

  int numAttachments() const { return static_cast<int>(attachments_.size()); }
  /// Null if there is none.
  AttachmentDevice* attachment(int index);
  /// False if it is attached already.
  bool addAttachment(AttachmentDevice* attachment);
  /// No effect, or false, if there is none such.
  void removeAttachment(int index);
  bool removeAttachment(AttachmentDevice* attachment);
  void clearAttachments();

 protected:
  /// A copy holds nothing.
  HolderDevice(const HolderDevice& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  bool on_ = false;
  std::vector<std::string> categories_;
  int holdCondition_ = Distance;
  double maxHoldDistance_ = 0.1;
  std::string holdTargetName_;
  std::vector<ref_ptr<AttachmentDevice>> attachments_;
};

using HolderDevicePtr = ref_ptr<HolderDevice>;

}  // namespace cnoid
