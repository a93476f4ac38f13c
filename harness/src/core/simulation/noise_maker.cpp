#include "noise_maker.h"

#include "core/scenario/normal_quantile.h"

#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mcap/hashing.h"
#include "model/chance.h"

namespace rehearse {
namespace {

// The random numbers of one reading: each place in it has a different one.

double normal(const Chance& chance, std::uint64_t place) { return normal_quantile(chance.uniform(place)); }

/// True for a given share of all places.
bool loses(const Chance& chance, std::uint64_t place, double share) {
  constexpr std::uint64_t other_numbers = 1ull << 62;  // different from the numbers for values
  return share > 0.0 && chance.uniform(other_numbers + place) < share;
}

double disturbed(double truth, const Noise& noise, int axis, const Chance& chance, std::uint64_t place) {
  const double random = noise.stddev > 0.0 ? noise.stddev * normal(chance, place) : 0.0;
  return truth + noise.bias[axis] + random;
}

/// Adds noise to quantities of three numbers each; those of a contact sensor follow its count.
void disturb_values(const DeviceNoise& noise, bool has_count, const Chance& chance, std::vector<double>& values) {
  const std::size_t first = has_count ? 1 : 0;
  for (std::size_t i = first; i < values.size(); ++i) {
    const Noise& of_quantity = noise.quantities.at((i - first) / 3);
    values[i] = disturbed(values[i], of_quantity, static_cast<int>((i - first) % 3), chance, i);
  }
}

/// Adds noise to distances; a noisy distance is never smaller than 0.
template <class Floats>
void disturb_distances(const Noise& noise, double dropout, const Chance& chance, std::uint64_t first_place,
                       Floats& distances) {
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const std::uint64_t place = first_place + i;
    if (!std::isfinite(distances[i])) continue;
    distances[i] = loses(chance, place, dropout)
                       ? std::numeric_limits<float>::infinity()
                       : static_cast<float>(std::max(0.0, disturbed(distances[i], noise, 0, chance, place)));
  }
}

void disturb_colors(const Noise& noise, const Chance& chance, std::vector<std::uint8_t>& colors) {
  for (std::size_t i = 0; i < colors.size(); ++i)
    colors[i] =
        static_cast<std::uint8_t>(std::clamp(std::round(disturbed(colors[i], noise, 0, chance, i)), 0.0, 255.0));
}

/// Adds noise to a new capture.
void disturb_capture(const DeviceNoise& noise, const Chance& chance, DeviceReading& reading) {
  if (reading.ranges) {
    auto ranges = std::make_shared<std::vector<float>>(*reading.ranges);
    disturb_distances(noise.quantities.at(0), noise.dropout, chance, 0, *ranges);
    reading.ranges = std::move(ranges);
  }
  if (reading.image && !noise.quantities.at(0).changes_nothing()) {
    auto image = std::make_shared<Image>(*reading.image);
    image->file.clear();
    disturb_colors(noise.quantities[0], chance, image->pixels);
    reading.image = std::move(image);
  }
  if (reading.depth) {
    auto depth = std::make_shared<DepthImage>(*reading.depth);
    const std::uint64_t behind_the_colors = 3 * depth->meters.size();
    disturb_distances(noise.quantities.at(1), noise.dropout, chance, behind_the_colors, depth->meters);
    round_to_resolution(*depth);
    reading.depth = std::move(depth);
  }
}

/// True for sensors whose dropout applies to whole readings.
bool drops_readings(const Device& device) {
  const auto* camera = std::get_if<Camera>(&device.kind);
  return camera ? !camera->depth : !std::holds_alternative<RangeSensor>(device.kind);
}

}  // namespace

std::uint64_t key_of(std::string_view kind, const std::string& body, const std::string& name, std::uint32_t seed) {
  const std::string text = std::string(kind) + ":" + body + "/" + name;
  return hash_bytes(text.data(), text.size(), seed);
}

NoiseMaker::NoiseMaker(const Scenario& scenario) {
  for (std::size_t body = 0; body < scenario.bodies.size(); ++body) {
    const ScenarioBody& of = scenario.bodies[body];
    for (std::size_t i = 0; i < of.noise.devices.size(); ++i) {
      if (of.noise.devices[i].changes_nothing()) continue;
      const Device& device = of.model->devices[i];
      devices_.push_back({static_cast<int>(body),
                          static_cast<int>(i),
                          &device,
                          &of.noise.devices[i],
                          key_of("sensor", of.name, device.name, scenario.seed),
                          {}});
    }
    for (std::size_t id = 0; id < of.noise.joints.size(); ++id) {
      if (of.noise.joints[id].changes_nothing()) continue;
      const Joint& joint = of.model->links[static_cast<std::size_t>(of.model->joints[id])].joint;
      joints_.push_back({static_cast<int>(body), static_cast<int>(id), &of.noise.joints[id],
                         key_of("joint", of.name, joint.name, scenario.seed)});
    }
  }
}

void NoiseMaker::disturb_devices(std::int64_t tick, Observation& observation) {
  for (NoisyDevice& noisy : devices_) {
    DeviceReading& reading = observation.bodies[noisy.body].devices[noisy.device];
    const Chance chance(noisy.key, tick);
    const bool is_lost = drops_readings(*noisy.description) && loses(chance, 0, noisy.noise->dropout);
    if (value_count(*noisy.description) > 0) {
      if (!reading.fresh) continue;
      const bool has_count = std::holds_alternative<ContactSensor>(noisy.description->kind);
      disturb_values(*noisy.noise, has_count, chance, reading.values);
      reading.fresh = !is_lost;
      continue;
    }
    const bool has_capture = reading.image || reading.depth || reading.ranges;
    const bool is_new = reading.fresh && !(is_lost && has_capture);
    if (is_new && has_capture) disturb_capture(*noisy.noise, chance, reading);
    if (is_new || !has_capture) {
      noisy.last = reading;
    } else {
      reading = noisy.last;  // the reading of the last capture that arrived
      reading.fresh = false;
    }
  }
}

void NoiseMaker::disturb_joints(std::int64_t tick, Observation& observation) const {
  for (const NoisyJoint& noisy : joints_) {
    JointReading& reading = observation.bodies[noisy.body].joints[noisy.id];
    const Chance chance(noisy.key, tick);
    double* const values[joint_quantity_count] = {&reading.q, &reading.dq, &reading.u};
    for (std::size_t i = 0; i < joint_quantity_count; ++i)
      *values[i] = disturbed(*values[i], noisy.noise->quantities[i], 0, chance, i);
  }
}

}  // namespace rehearse
