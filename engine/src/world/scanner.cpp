#include "scanner.h"

#include "model/capture_cycle.h"

namespace rehearse {
namespace {

using Scan = std::shared_ptr<const std::vector<float>>;

struct ActiveSensor {
  int body = 0;
  int device = 0;
  CaptureCycle<Scan> cycle;
};

}  // namespace

struct Scanner::Impl {
  const World& world;
  std::vector<ActiveSensor> sensors;
};

Scanner::Scanner(const World& world, double time_step, const std::vector<std::shared_ptr<const Model>>& models)
    : impl_(new Impl{world, {}}) {
  for (std::size_t body = 0; body < models.size(); ++body) {
    for (std::size_t device = 0; device < models[body]->devices.size(); ++device) {
      if (const auto* sensor = std::get_if<RangeSensor>(&models[body]->devices[device].kind))
        impl_->sensors.push_back({static_cast<int>(body), static_cast<int>(device), {sensor->scan_rate, time_step}});
    }
  }
}

Scanner::~Scanner() = default;

void Scanner::look(std::int64_t tick, Observation& observation) {
  for (ActiveSensor& sensor : impl_->sensors) {
    DeviceReading& reading = observation.bodies[sensor.body].devices[sensor.device];
    reading.fresh = sensor.cycle.deliver(tick);
    reading.measured_at = sensor.cycle.captured_at();
    reading.ranges = sensor.cycle.current();
    if (!sensor.cycle.is_due(tick)) continue;
    sensor.cycle.capture(
        tick, std::make_shared<const std::vector<float>>(impl_->world.measure_ranges(sensor.body, sensor.device)));
  }
}

void Scanner::begin_at(std::int64_t tick) {
  for (ActiveSensor& sensor : impl_->sensors) sensor.cycle.begin_at(tick);
}

void Scanner::switch_sensors(std::int64_t tick, const Command& command) {
  for (ActiveSensor& sensor : impl_->sensors) {
    const DeviceCommand& wanted = command.bodies[sensor.body].devices[sensor.device];
    if (wanted.fresh) sensor.cycle.switch_to(wanted.on, tick);
  }
}

}  // namespace rehearse
