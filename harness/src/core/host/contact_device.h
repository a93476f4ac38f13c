// ContactDevice: a model's ContactSensor as a device for controllers. Choreonoid has no such device, so a controller
// reads it as any Device: writeState() gives the number of contact points and the force x, y, z [N] on the link.
#pragma once

#include <algorithm>
#include <array>
#include <cnoid/Device>
#include <stdexcept>

namespace rehearse {

class ContactDevice final : public cnoid::Device {
 public:
  const char* typeName() const override { return "ContactSensor"; }
  void copyStateFrom(const cnoid::DeviceState& other) override {
    const auto* same = dynamic_cast<const ContactDevice*>(&other);
    if (!same) throw std::invalid_argument("a ContactSensor takes the state of a ContactSensor only");
    values_ = same->values_;
  }
  void clearState() override { values_ = {}; }
  int stateSize() const override { return static_cast<int>(values_.size()); }
  double* writeState(double* buffer) const override { return std::copy(values_.begin(), values_.end(), buffer); }
  const double* readState(const double* buffer, int size) override {
    if (size < stateSize()) return buffer;
    std::copy(buffer, buffer + stateSize(), values_.begin());
    return buffer + stateSize();
  }

 protected:
  cnoid::Referenced* doClone(cnoid::CloneMap*) const override { return new ContactDevice(*this); }

 private:
  std::array<double, 4> values_{};
};

}  // namespace rehearse
