// Copies the state of one device to another of exactly the same type.
#pragma once

#include <cnoid/Device>
#include <stdexcept>
#include <string>
#include <typeinfo>

namespace cnoid {

template <class DeviceType>
const DeviceType& sameType(const DeviceState& other) {
  if (typeid(other) != typeid(DeviceType)) {
    throw std::invalid_argument(std::string("copyStateFrom: the source is a ") + other.typeName() +
                                ", not of the device's own type");
  }
  return static_cast<const DeviceType&>(other);
}

}  // namespace cnoid
