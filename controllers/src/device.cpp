#include <cnoid/Device>
#include <cnoid/Link>

namespace cnoid {

DeviceState::~DeviceState() = default;

Device::Device() : T_local_(Isometry3::Identity()), info_(new Mapping) {}

// Signals are not copied: a slot that is connected to one device is not connected to its copies.
Device::Device(const Device& other)
    : DeviceState(other),
      id_(other.id_),
      name_(other.name_),
      T_local_(other.T_local_),
      info_(other.info_->deepClone()) {}

Device::~Device() = default;

DeviceState* Device::cloneState(DeviceState*) const { return clone(); }

Body* Device::body() { return link_ ? link_->body() : nullptr; }

const Body* Device::body() const { return link_ ? link_->body() : nullptr; }

bool Device::on() const { return true; }

void Device::on(bool) {}

void Device::clearState() {}

}  // namespace cnoid
