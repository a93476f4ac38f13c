// The hashes of a tick: all that controllers read, and all that they command.
#include "base/hashing.h"
#include "controller_host.h"

namespace rehearse {
namespace {

std::uint64_t hash_values(const std::vector<double>& values, std::uint64_t seed) {
  return hash_bytes(values.data(), values.size() * sizeof(double), seed);
}

std::uint64_t hash_contacts(const std::vector<ContactReading>& contacts, std::uint64_t seed) {
  static_assert(sizeof(ContactReading) == 13 * sizeof(double), "nothing but numbers");
  const std::uint64_t count = contacts.size();
  return hash_bytes(contacts.data(), contacts.size() * sizeof(ContactReading), hash_bytes(&count, sizeof count, seed));
}

std::uint64_t hash_joystick(const JoystickReading& reading, std::uint64_t seed) {
  const std::uint64_t axes = hash_bytes(reading.axes.data(), sizeof reading.axes, seed);
  return hash_bytes(reading.buttons.data(), sizeof reading.buttons, axes);
}

}  // namespace

std::uint64_t ControllerHost::input_hash(const Observation& seen) const {
  std::uint64_t hash = seen.joystick ? hash_joystick(*seen.joystick, 0) : 0;
  for (const HostedController& hosted : controllers_) {
    if (!hosted.tick.has_input) continue;
    hash = hash_values(hosted.io->input_values(), hash);
    for (const std::vector<ContactReading>& contacts : hosted.io->input_contacts())
      hash = hash_contacts(contacts, hash);
    for (const int device : hosted.io->input_devices()) {
      const DeviceReading& reading = seen.bodies[hosted.body].devices[device];
      if (!reading.fresh) continue;
      hash = hash_values(reading.values, hash);
      if (reading.image) hash = hash_bytes(reading.image->pixels.data(), reading.image->pixels.size(), hash);
      if (reading.depth)
        hash = hash_bytes(reading.depth->meters.data(), reading.depth->meters.size() * sizeof(float), hash);
      if (reading.ranges) hash = hash_bytes(reading.ranges->data(), reading.ranges->size() * sizeof(float), hash);
    }
  }
  return hash;
}

std::uint64_t ControllerHost::output_hash() const {
  std::uint64_t hash = 0;
  for (const HostedController& hosted : controllers_) {
    const unsigned char result = hosted.tick.result ? 1 : 0;
    hash = hash_bytes(&result, 1, hash);
    if (!hosted.tick.has_output) continue;
    hash = hash_values(hosted.io->output_values(), hash);
    if (hosted.acts_at_another_time()) hash = hash_bytes(&hosted.tick.delayed, sizeof hosted.tick.delayed, hash);
    for (const DeviceOutput& output : hosted.tick.device_outputs) {
      hash = hash_bytes(&output.device, sizeof output.device, hash);
      hash = hash_values(output.values, hash);
    }
  }
  return hash;
}

}  // namespace rehearse
