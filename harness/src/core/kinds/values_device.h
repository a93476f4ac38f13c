// ValuesDevice: a sensor that Choreonoid doesn't have, as a device for controllers. A controller reads it as any
// Device: writeState() gives its numbers, as TRACE_FORMAT.md lists them.
#pragma once

#include <algorithm>
#include <cnoid/Device>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

class ValuesDevice final : public cnoid::Device {
 public:
  ValuesDevice(std::string type, std::size_t count) : type_(std::move(type)), values_(count, 0.0) {}

  const char* typeName() const override { return type_.c_str(); }
  void copyStateFrom(const cnoid::DeviceState& other) override {
    const auto* same = dynamic_cast<const ValuesDevice*>(&other);
    if (!same || same->type_ != type_)
      throw std::invalid_argument("a " + type_ + " takes the state of a " + type_ + " only");
    values_ = same->values_;
  }
  void clearState() override { std::ranges::fill(values_, 0.0); }
  int stateSize() const override { return static_cast<int>(values_.size()); }
  double* writeState(double* buffer) const override { return std::copy(values_.begin(), values_.end(), buffer); }
  const double* readState(const double* buffer, int size) override {
    if (size < stateSize()) return buffer;
    std::copy(buffer, buffer + stateSize(), values_.begin());
    return buffer + stateSize();
  }

 protected:
  cnoid::Referenced* doClone(cnoid::CloneMap*) const override { return new ValuesDevice(*this); }

 private:
  std::string type_;
  std::vector<double> values_;
};

}  // namespace rehearse
