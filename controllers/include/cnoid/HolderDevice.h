// HolderDevice: a gripper that, while on, holds objects that can be attached to it.
//
// Its state is on(). After notifyStateChange() Rehearse attaches one link of another body when the condition of the
// model's holder is met, and detaches it when the holder is off.
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

  /// The categories of attachments that it can hold; without categories: all.
  const std::vector<std::string>& categories() const { return categories_; }
  bool hasCategories() const { return !categories_.empty(); }
  bool hasCategory(const std::string& category) const;
  /// An empty name is not added.
  void addCategory(const std::string& category);
  void clearCategories() { categories_.clear(); }

  /// The condition for holding an object: it is near, it is touched, or it has the given name.
  enum HoldCondition { Distance, Collision, Name };
  int holdCondition() const { return holdCondition_; }
  void setHoldCondition(int condition) { holdCondition_ = condition; }
  double maxHoldDistance() const { return maxHoldDistance_; }  // [m]
  void setMaxHoldDistance(double distance) { maxHoldDistance_ = distance; }
  const std::string& holdTargetName() const { return holdTargetName_; }
  void setHoldTargetName(const std::string& name) { holdTargetName_ = name; }

  int numAttachments() const { return static_cast<int>(attachments_.size()); }
  /// Null if the index is out of range.
  AttachmentDevice* attachment(int index);
  /// False if the attachment is already attached.
  bool addAttachment(AttachmentDevice* attachment);
  /// No effect, or false, if the attachment doesn't exist.
  void removeAttachment(int index);
  bool removeAttachment(AttachmentDevice* attachment);
  void clearAttachments();

 protected:
  /// A copy has no attachments.
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
