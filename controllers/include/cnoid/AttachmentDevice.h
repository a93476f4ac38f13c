// AttachmentDevice: the place by which an object is held by a HolderDevice.
#pragma once

#include "Device.h"

#include <string>

namespace cnoid {

class HolderDevice;

class CNOID_GENERAL_EXPORT AttachmentDevice : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  AttachmentDevice();
  ~AttachmentDevice() override;

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // on
  const double* readState(const double* buffer, int size) override;

  bool on() const override;
  void on(bool on) override;

  /// What holds it, or null.
  HolderDevice* holder() const;
  bool isAttaching() const { return holder() != nullptr; }
  void detach();

  const std::string& category() const { return category_; }
  void setCategory(const std::string& category) { category_ = category; }
  void clearCategory() { category_.clear(); }
  /// A holder of another body that has no categories, or this one's.
  bool isAttachableTo(const HolderDevice* holder) const;

 protected:
  /// A copy is attached to nothing.
  AttachmentDevice(const AttachmentDevice& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  friend class HolderDevice;
  void setHolder(HolderDevice* holder) { holder_ = holder; }

  bool on_ = true;
  std::string category_;
  HolderDevice* holder_ = nullptr;  // which forgets us when it goes
};

using AttachmentDevicePtr = ref_ptr<AttachmentDevice>;

}  // namespace cnoid
