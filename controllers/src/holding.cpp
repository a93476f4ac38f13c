#include <algorithm>
#include <cnoid/AttachmentDevice>
#include <cnoid/HolderDevice>

#include "device_state_cast.h"

namespace cnoid {

HolderDevice::HolderDevice() = default;

HolderDevice::HolderDevice(const HolderDevice& other)
    : Device(other),
      on_(other.on_),
      categories_(other.categories_),
      holdCondition_(other.holdCondition_),
      maxHoldDistance_(other.maxHoldDistance_),
      holdTargetName_(other.holdTargetName_) {}

HolderDevice::~HolderDevice() { clearAttachments(); }

Referenced* HolderDevice::doClone(CloneMap*) const { return new HolderDevice(*this); }

const char* HolderDevice::typeName() const { return "HolderDevice"; }

void HolderDevice::copyStateFrom(const DeviceState& other) { on_ = sameType<HolderDevice>(other).on_; }

int HolderDevice::stateSize() const { return 1; }

double* HolderDevice::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  return buffer + 1;
}

const double* HolderDevice::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  return buffer + 1;
}

bool HolderDevice::on() const { return on_; }

void HolderDevice::on(bool on) { on_ = on; }

bool HolderDevice::hasCategory(const std::string& category) const {
  return std::find(categories_.begin(), categories_.end(), category) != categories_.end();
}

void HolderDevice::addCategory(const std::string& category) {
  if (!category.empty()) categories_.push_back(category);
}

AttachmentDevice* HolderDevice::attachment(int index) {
  return index >= 0 && index < numAttachments() ? attachments_[static_cast<std::size_t>(index)].get() : nullptr;
}

bool HolderDevice::addAttachment(AttachmentDevice* attachment) {
  const AttachmentDevicePtr owner(attachment);
  if (attachment->holder() == this) return false;
  attachment->detach();
  attachments_.push_back(owner);
  attachment->setHolder(this);
  return true;
}

void HolderDevice::removeAttachment(int index) {
  if (AttachmentDevice* held = attachment(index)) removeAttachment(held);
}

bool HolderDevice::removeAttachment(AttachmentDevice* attachment) {
  const auto place = std::find(attachments_.begin(), attachments_.end(), AttachmentDevicePtr(attachment));
  if (place == attachments_.end()) return false;
  attachment->setHolder(nullptr);
  attachments_.erase(place);
  return true;
}

void HolderDevice::clearAttachments() {
  for (const auto& attachment : attachments_) attachment->setHolder(nullptr);
  attachments_.clear();
}

AttachmentDevice::AttachmentDevice() = default;

AttachmentDevice::AttachmentDevice(const AttachmentDevice& other)
    : Device(other), on_(other.on_), category_(other.category_) {}

AttachmentDevice::~AttachmentDevice() = default;

Referenced* AttachmentDevice::doClone(CloneMap*) const { return new AttachmentDevice(*this); }

const char* AttachmentDevice::typeName() const { return "AttachmentDevice"; }

void AttachmentDevice::copyStateFrom(const DeviceState& other) { on_ = sameType<AttachmentDevice>(other).on_; }

int AttachmentDevice::stateSize() const { return 1; }

double* AttachmentDevice::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  return buffer + 1;
}

const double* AttachmentDevice::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  return buffer + 1;
}

bool AttachmentDevice::on() const { return on_; }

void AttachmentDevice::on(bool on) { on_ = on; }

HolderDevice* AttachmentDevice::holder() const { return holder_; }

void AttachmentDevice::detach() {
  if (holder_) holder_->removeAttachment(this);
}

bool AttachmentDevice::isAttachableTo(const HolderDevice* holder) const {
  if (body() == holder->body()) return false;
  return !holder->hasCategories() || holder->hasCategory(category_);
}

}  // namespace cnoid
