// The measurement of an IMU, a gyro or an accelerometer.
#include <cnoid/AccelerationSensor>
#include <cnoid/Imu>
#include <cnoid/RateGyroSensor>

#include "number_message.h"

namespace rehearse {
namespace {

constexpr ElementGroup imu_groups[] = {{"angular_velocity", "rad/s", "xyz"}, {"linear_acceleration", "m/s²", "xyz"}};
constexpr double no_covariance = -1.0;  // ROS: "this quantity is not measured"

auto places_of_imu(msg::Imu& message) { return numbers_in(message.angular_velocity, message.linear_acceleration); }

bool turns(const Device& device) { return !std::holds_alternative<Accelerometer>(device.kind); }
bool accelerates(const Device& device) { return !std::holds_alternative<Gyro>(device.kind); }

/// Of the elements a gyro measures the first three, an accelerometer the last three, an Imu all.
std::size_t first_of_imu(const Device& device) { return turns(device) ? 0 : 3; }

constexpr LogInput imu_input{.content = LogInput::Content::numbers,
                             .key = "imus",
                             .form = "imu_source",
                             .owner = "an IMU",
                             .devices = "gyros, accelerometers and IMUs",
                             .messages = "an Imu"};
constexpr DeviceMeasurement imu_measurement{
    .log = imu_input,
    .encode =
        [](const Device& device, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          msg::Imu imu;
          imu.header = header;
          imu.orientation_covariance[0] = no_covariance;
          imu.angular_velocity_covariance[0] = turns(device) ? 0.0 : no_covariance;
          imu.linear_acceleration_covariance[0] = accelerates(device) ? 0.0 : no_covariance;
          const auto places = places_of_imu(imu);
          for (std::size_t i = 0; i < reading.values.size(); ++i)
            *places.at(first_of_imu(device) + i) = reading.values[i];
          msg::encode(imu, message.cdr);
          return true;
        },
    .decode = [](const Device& device, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::Imu imu;
      CdrReader reader(bytes);
      if (!msg::decode(reader, imu)) return false;
      const auto places = places_of_imu(imu);
      reading.values.clear();
      for (int i = 0; i < value_count(device); ++i)
        reading.values.push_back(*places.at(first_of_imu(device) + static_cast<std::size_t>(i)));
      return true;
    },
    .first_element = first_of_imu,
    .make = [](const Device& device) -> cnoid::Device* {
      if (!accelerates(device)) return new cnoid::RateGyroSensor;
      if (!turns(device)) return new cnoid::AccelerationSensor;
      return new cnoid::Imu;
    }};

}  // namespace

const ChannelForm imu_kind{.level = ChannelForm::Level::owner,
                           .segment = "imu",
                           .type = msg::Imu::type_name,
                           .schema = msg::schema_text<msg::Imu>,
                           .stage = Stage::sensors,
                           .groups = imu_groups,
                           .has_fixed_elements = true,
                           .is_state = true,
                           .make_rows = number_rows<msg::Imu, places_of_imu, ChannelKind::imu>,
                           .numbers = &number_message<msg::Imu, places_of_imu>,
                           .measurement = &imu_measurement};

}  // namespace rehearse
