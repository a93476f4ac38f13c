// AttachmentDevice: the place at which a HolderDevice can hold an object.
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

  /// The holder to which it is attached, or null.
  HolderDevice* holder() const;
  bool isAttaching() const { return holder() != nullptr; }
  void detach();

  const std::string& category() const { return category_; }
  void setCategory(const std::string& category) { category_ = category; }
  void clearCategory() { category_.clear(); }
  /// True for a holder of a different body that has no category or the category of this attachment.
  bool isAttachableTo(const HolderDevice* holder) const;

 protected:
  /// A copy is not attached.
  AttachmentDevice(const AttachmentDevice& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  friend class HolderDevice;
  void setHolder(HolderDevice* holder) { holder_ = holder; }

  bool on_ = true;
  std::string category_;
  HolderDevice* holder_ = nullptr;  // its destructor resets this pointer
};

using AttachmentDevicePtr = ref_ptr<AttachmentDevice>;

}  // namespace cnoid
