// DeviceList: a vector of devices of one type, which can be filled from lists of all types.
//
//   DeviceList<ForceSensor> sensors(body->devices());  // only the force sensors
//   sensors << body->devices();                        // the same, appended
#pragma once

#include "Device.h"

#include <cstddef>
#include <vector>

namespace cnoid {

template <class DeviceType = Device>
class DeviceList : public std::vector<ref_ptr<DeviceType>> {
  using Vector = std::vector<ref_ptr<DeviceType>>;

 public:
  DeviceList() = default;

  template <class Other>
  DeviceList(const DeviceList<Other>& others) {
    *this << others;
  }

  /// Appends the devices of this list's type from the other list, in their order.
  template <class Other>
  DeviceList& operator<<(const DeviceList<Other>& others) {
    for (const auto& other : others) try_push_back(other);
    return *this;
  }

  /// Appends the device if it is of this list's type; returns whether it did.
  bool try_push_back(Device* device) {
    auto* matching = dynamic_cast<DeviceType*>(device);
    if (matching) this->push_back(matching);
    return matching != nullptr;
  }

  /// Replaces the content by the devices of this list's type from the other list.
  template <class Other>
  DeviceList& assign(const DeviceList<Other>& others) {
    this->clear();
    return *this << others;
  }
  using Vector::assign;

  /// Moves the devices of this list's type from the other list to this one. True if there were any.
  template <class Other>
  bool extractFrom(DeviceList<Other>& others) {
    const std::size_t sizeBefore = this->size();
    DeviceList<Other> rest;
    for (const auto& other : others) {
      if (!try_push_back(other)) rest.push_back(other);
    }
    others.swap(rest);
    return this->size() > sizeBefore;
  }

  /// Removes the devices of type T from this list and returns them.
  template <class T>
  DeviceList<T> extract() {
    DeviceList<T> extracted;
    extracted.extractFrom(*this);
    return extracted;
  }

  /// The devices by id: element i is the device with id i, null if no device has this id. Devices without an id are
  /// left out.
  DeviceList getSortedById() const {
    DeviceList sorted;
    for (const auto& device : *this) {
      if (!device || device->id() < 0) continue;
      const auto id = static_cast<std::size_t>(device->id());
      if (id >= sorted.size()) sorted.resize(id + 1);
      sorted[id] = device;
    }
    return sorted;
  }
};

}  // namespace cnoid
