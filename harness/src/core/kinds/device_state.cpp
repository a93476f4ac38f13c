// The state of a light, and the numbers that a controller commands a device.
#include <cnoid/SpotLight>

#include "kind.h"

namespace rehearse {
namespace {

cnoid::Device* make_light(const Device& device) {
  const auto& light = std::get<Light>(device.kind);
  cnoid::PointLight* made = nullptr;
  if (light.cone) {
    auto* spot = new cnoid::SpotLight;
    spot->setDirection(light.cone->direction);
    spot->setBeamWidth(light.cone->beam_width);
    spot->setCutOffAngle(light.cone->cut_off_angle);
    spot->setCutOffExponent(light.cone->cut_off_exponent);
    made = spot;
  } else {
    made = new cnoid::PointLight;
  }
  made->on(light.on);
  made->setColor(light.color);
  made->setIntensity(light.intensity);
  made->setConstantAttenuation(light.constant);
  made->setLinearAttenuation(light.linear);
  made->setQuadraticAttenuation(light.quadratic);
  return made;
}

constexpr DeviceMeasurement light_measurement{
    .log = no_log_input,
    .encode =
        [](const Device&, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          msg::encode(msg::DeviceState{header, reading.values}, message.cdr);
          return true;
        },
    .decode = [](const Device&, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::DeviceState state;
      CdrReader reader(bytes);
      if (!msg::decode(reader, state)) return false;
      reading.values = std::move(state.values);
      return true;
    },
    .make = make_light};

}  // namespace

const ChannelForm device_state_kind{.level = ChannelForm::Level::owner,
                                    .segment = "state",
                                    .type = msg::DeviceState::type_name,
                                    .schema = msg::schema_text<msg::DeviceState>,
                                    .stage = Stage::physics,
                                    .measurement = &light_measurement};

}  // namespace rehearse
