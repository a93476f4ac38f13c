#include "sensor_errors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <variant>

#include "base/chance.h"
#include "base/hashing.h"

namespace rehearse {
namespace {

/// True for a given share of all places.
bool loses(const SensorSample& sample, std::uint64_t place, double share) {
  constexpr std::uint64_t other_numbers = 1ull << 62;  // different from the numbers for values
  return share > 0.0 && Chance(sample.key, sample.tick).uniform(other_numbers + place) < share;
}

/// True for sensors whose dropout without bursts applies to whole readings.
bool drops_readings(const Device& device) {
  const auto* camera = std::get_if<Camera>(&device.kind);
  return camera ? !camera->depth : !std::holds_alternative<RangeSensor>(device.kind);
}

/// The time between samples of a device [s].
double interval_of(const Device& device, double time_step) {
  double rate = 0.0;
  if (const auto* camera = std::get_if<Camera>(&device.kind)) rate = camera->frame_rate;
  if (const auto* range = std::get_if<RangeSensor>(&device.kind)) rate = range->scan_rate;
  return rate > 0.0 ? std::max(1.0 / rate, time_step) : time_step;
}

/// The share of readings that are lost one by one.
double single_dropout(const ReadingErrors& errors) { return errors.burst > 0.0 ? 0.0 : errors.dropout; }

constexpr std::size_t joint_numbers = 4;  // q, dq, ddq, u
constexpr double JointReading::*of_joint[] = {&JointReading::q, &JointReading::dq, &JointReading::ddq,
                                              &JointReading::u};
constexpr std::size_t number_of_quantity[joint_quantity_count] = {0, 1, 3};  // displacement, velocity, effort

}  // namespace

std::uint64_t key_of(std::string_view kind, const std::string& body, const std::string& name, std::uint32_t seed) {
  const std::string text = std::string(kind) + ":" + body + "/" + name;
  return hash_bytes(text.data(), text.size(), seed);
}

SensorErrors::Disturbed::Disturbed(const Scenario& scenario, int of_body, int of_index, const ReadingErrors& with,
                                   std::uint64_t with_key, double interval, std::size_t numbers)
    : body(of_body),
      index(of_index),
      errors(&with),
      key(with_key),
      line(with, with_key, scenario.time_step, interval, numbers),
      is_timed(with.is_timed()) {
  for (const QuantityErrors& quantity : with.quantities) memories.emplace_back(quantity.given.size());
}

SensorErrors::SensorErrors(const Scenario& scenario) {
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    for (std::size_t i = 0; i < body.errors.devices.size(); ++i) {
      const ReadingErrors& errors = body.errors.devices[i];
      const Device& device = body.model->devices[i];
      if (errors.changes_nothing()) continue;
      const auto numbers = static_cast<std::size_t>(value_count(device));
      devices_.emplace_back(scenario, static_cast<int>(b), static_cast<int>(i), errors,
                            key_of("sensor", body.name, device.name, scenario.seed),
                            interval_of(device, scenario.time_step), numbers);
      devices_.back().device = &device;
      if (numbers > 0 && errors.records_truth()) truths_.push_back({static_cast<int>(b), static_cast<int>(i), {}});
    }
    for (std::size_t id = 0; id < body.errors.joints.size(); ++id) {
      const ReadingErrors& errors = body.errors.joints[id];
      if (errors.changes_nothing()) continue;
      const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
      joints_.emplace_back(scenario, static_cast<int>(b), static_cast<int>(id), errors,
                           key_of("joint", body.name, joint.name, scenario.seed), scenario.time_step, joint_numbers);
    }
  }
}

/// `numbers`: one, or the axes of the quantity.
void SensorErrors::disturb_numbers(Disturbed& target, std::size_t quantity, SensorSample sample,
                                   std::span<double> numbers) {
  for (double& number : numbers) number += 0.0;  // no reading is -0, so that an error of 0 changes no bit
  if (quantity >= target.errors->quantities.size()) return;
  const std::vector<GivenError>& given = target.errors->quantities[quantity].given;
  const double time = static_cast<double>(sample.tick) * target.line.time_step();
  for (std::size_t i = 0; i < given.size(); ++i)
    if (given[i].when.holds(time)) given[i].form->apply(given[i], sample, target.memories[quantity][i], numbers);
}

/// Quantities of three numbers each; those of a contact sensor follow its count.
void SensorErrors::disturb_values(Disturbed& target, std::int64_t tick, DeviceReading& reading) {
  if (!reading.fresh && !target.is_timed) return;
  const auto sample = reading.fresh ? target.line.sample_of(tick) : std::nullopt;
  bool is_lost = false;
  if (sample) {
    const SensorSample at{target.key, tick, *sample, target.line.interval(), 0, 0};
    const std::size_t first = std::holds_alternative<ContactSensor>(target.device->kind) ? 1 : 0;
    for (std::size_t i = first; i + 3 <= reading.values.size(); i += 3) {
      SensorSample numbers = at;
      numbers.place = numbers.first = i;
      disturb_numbers(target, (i - first) / 3, numbers, std::span(reading.values).subspan(i, 3));
    }
    is_lost = loses(at, 0, single_dropout(*target.errors));
  }
  reading.fresh = target.is_timed ? target.line.pass(tick, is_lost ? std::nullopt : sample, reading.values) : !is_lost;
}

/// A distance is never smaller than 0.
template <class Floats>
void SensorErrors::disturb_distances(Disturbed& target, std::size_t quantity, SensorSample sample, Floats& distances) {
  const std::size_t first = sample.place;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (!std::isfinite(distances[i])) continue;
    sample.place = first + i;
    double distance = distances[i];
    disturb_numbers(target, quantity, sample, std::span(&distance, 1));
    distances[i] = loses(sample, sample.place, single_dropout(*target.errors))
                       ? std::numeric_limits<float>::infinity()
                       : static_cast<float>(std::max(0.0, distance));
  }
}

void SensorErrors::disturb_capture(Disturbed& target, const SensorSample& sample, DeviceReading& reading) {
  if (reading.ranges) {
    auto ranges = std::make_shared<std::vector<float>>(*reading.ranges);
    disturb_distances(target, 0, sample, *ranges);
    reading.ranges = std::move(ranges);
  }
  if (reading.image && !target.errors->quantities.empty() && !target.errors->quantities[0].changes_nothing()) {
    auto image = std::make_shared<Image>(*reading.image);
    image->file.clear();
    for (std::size_t i = 0; i < image->pixels.size(); ++i) {
      SensorSample pixel = sample;
      pixel.place = i;
      double color = image->pixels[i];
      disturb_numbers(target, 0, pixel, std::span(&color, 1));
      image->pixels[i] = static_cast<std::uint8_t>(std::clamp(std::round(color), 0.0, 255.0));
    }
    reading.image = std::move(image);
  }
  if (reading.depth) {
    auto depth = std::make_shared<DepthImage>(*reading.depth);
    SensorSample behind_the_colors = sample;
    behind_the_colors.place = behind_the_colors.first = 3 * depth->meters.size();
    disturb_distances(target, 1, behind_the_colors, depth->meters);
    round_to_resolution(*depth);
    reading.depth = std::move(depth);
  }
}

/// The reading of a camera or range sensor.
void SensorErrors::pass_capture(Disturbed& target, std::int64_t tick, DeviceReading& reading) {
  const auto index = std::llround(static_cast<double>(tick) * target.line.time_step() / target.line.interval());
  const SensorSample sample{target.key, tick, index, target.line.interval(), 0, 0};
  const bool has_capture = reading.image || reading.depth || reading.ranges;
  const bool is_lost = drops_readings(*target.device) && loses(sample, 0, single_dropout(*target.errors));
  bool is_new = reading.fresh && !(is_lost && has_capture);
  if (is_new && has_capture) {
    if (target.is_timed) is_new = !target.line.is_lost(tick, index) && !target.line.is_stuck(tick);
    if (is_new) disturb_capture(target, sample, reading);
    if (is_new && target.line.arrival_of(tick) > tick) {
      target.captures.emplace_back(target.line.arrival_of(tick), reading);
      is_new = false;
    }
  }
  for (; !target.captures.empty() && target.captures.front().first <= tick; target.captures.pop_front()) {
    reading = target.captures.front().second;
    is_new = true;
  }
  if (is_new || !has_capture) {
    target.last = reading;
  } else {
    reading = target.last;  // the reading of the last capture that arrived
    reading.fresh = false;
  }
}

void SensorErrors::disturb_devices(std::int64_t tick, Observation& observation) {
  for (TrueReading& truth : truths_)
    truth.values =
        observation.bodies[static_cast<std::size_t>(truth.body)].devices[static_cast<std::size_t>(truth.device)].values;
  for (Disturbed& target : devices_) {
    DeviceReading& reading = observation.bodies[target.body].devices[target.index];
    if (value_count(*target.device) > 0)
      disturb_values(target, tick, reading);
    else
      pass_capture(target, tick, reading);
  }
}

void SensorErrors::disturb_joints(std::int64_t tick, Observation& observation) {
  for (Disturbed& target : joints_) {
    JointReading& reading = observation.bodies[target.body].joints[target.index];
    target.values.resize(joint_numbers);
    for (std::size_t i = 0; i < joint_numbers; ++i) target.values[i] = reading.*of_joint[i];
    auto sample = target.line.sample_of(tick);
    const SensorSample at{target.key, tick, sample.value_or(0), target.line.interval(), 0, 0};
    for (std::size_t i = 0; sample && i < joint_quantity_count; ++i) {
      SensorSample number = at;
      number.place = number.first = i;
      disturb_numbers(target, i, number, std::span(target.values).subspan(number_of_quantity[i], 1));
    }
    if (loses(at, 0, single_dropout(*target.errors))) sample.reset();
    if (target.is_timed || target.errors->dropout > 0.0) target.line.pass(tick, sample, target.values);
    for (std::size_t i = 0; i < joint_numbers; ++i) reading.*of_joint[i] = target.values[i];
  }
}

template <class Visit>
void SensorErrors::visit_state(Visit visit) {
  for (std::vector<Disturbed>* targets : {&devices_, &joints_})
    for (Disturbed& target : *targets)
      if (target.is_timed || (!target.device && target.errors->dropout > 0.0)) target.line.visit_state(visit);
}

std::vector<std::byte> SensorErrors::save() {
  std::vector<std::byte> state;
  visit_state([&](double& number) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&number);
    state.insert(state.end(), bytes, bytes + sizeof number);
  });
  return state;
}

void SensorErrors::restore(std::span<const std::byte> state) {
  std::size_t size = 0;
  visit_state([&](double&) { size += sizeof(double); });
  for (std::vector<Disturbed>* targets : {&devices_, &joints_})
    for (Disturbed& target : *targets) target.captures.clear();
  if (size != state.size()) return;
  std::size_t at = 0;
  visit_state([&](double& number) {
    std::memcpy(&number, state.data() + at, sizeof number);
    at += sizeof number;
  });
}

}  // namespace rehearse
