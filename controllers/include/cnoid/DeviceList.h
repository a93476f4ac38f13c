// DeviceList: a vector of devices of one type, that picks its elements out of other lists.
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

  /// Appends those of the others that are of this list's type, in their order.
  template <class Other>
  DeviceList& operator<<(const DeviceList<Other>& others) {
    for (const auto& other : others) try_push_back(other);
    return *this;
  }

  /// Appends the device if it is of this list's type, and says whether it was.
  bool try_push_back(Device* device) {
    auto* matching = dynamic_cast<DeviceType*>(device);
    if (matching) this->push_back(matching);
    return matching != nullptr;
  }

  /// Becomes the selection from another list.
  template <class Other>
  DeviceList& assign(const DeviceList<Other>& others) {
    this->clear();
    return *this << others;
  }
  using Vector::assign;

  /// Moves those of the other list that are of this list's type over here. True if there were any.
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

  /// Takes those of type T out of this list and returns them.
  template <class T>
  DeviceList<T> extract() {
    DeviceList<T> extracted;
    extracted.extractFrom(*this);
    return extracted;
  }

  /// By id: element i is the device with id i, null where there is none. Devices without an id are left out.
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
