#include "range_frame.h"

#include <cnoid/RangeSensor>
#include <memory>
#include <utility>

namespace rehearse {

Eigen::Matrix3d scan_axes() {
  return (Eigen::Matrix3d() << 0, -1, 0,  //
          0, 0, 1,                        //
          -1, 0, 0)
      .finished();
}

const std::vector<float>& ranges_of(const DeviceReading& reading) {
  static const std::vector<float> none;
  return reading.ranges ? *reading.ranges : none;
}

bool set_ranges(const RangeSensor& sensor, std::vector<float> ranges, DeviceReading& reading) {
  if (!ranges.empty() && ranges.size() != static_cast<std::size_t>(sensor.beams())) return false;
  reading.ranges = ranges.empty() ? nullptr : std::make_shared<const std::vector<float>>(std::move(ranges));
  return true;
}

cnoid::Device* make_range_sensor(const Device& device) {
  const auto& sensor = std::get<RangeSensor>(device.kind);
  auto* made = new cnoid::RangeSensor;
  made->setYawRange(sensor.yaw.lower, sensor.yaw.upper);
  made->setNumYawSamples(sensor.yaw.samples);
  made->setPitchRange(sensor.pitch.lower, sensor.pitch.upper);
  made->setNumPitchSamples(sensor.pitch.samples);
  made->setMinDistance(sensor.min_distance);
  made->setMaxDistance(sensor.max_distance);
  made->setScanRate(sensor.scan_rate);
  return made;
}

void feed_range_sensor(cnoid::Device& target, const Device&, const DeviceReading& reading, double now) {
  auto& sensor = static_cast<cnoid::RangeSensor&>(target);
  if (!reading.ranges) {
    sensor.clearState();
    return;
  }
  auto ranges = std::make_shared<cnoid::RangeSensor::RangeData>(reading.ranges->begin(), reading.ranges->end());
  sensor.setRangeData(ranges);
  sensor.setDelay(now - reading.measured_at);
}

}  // namespace rehearse
