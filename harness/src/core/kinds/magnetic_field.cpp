// The measurement of a magnetometer.
#include <array>

#include "number_message.h"

namespace rehearse {
namespace msg {

/// A covariance whose first element is 0: it is unknown.
struct MagneticField {
  static constexpr std::string_view type_name = "sensor_msgs/msg/MagneticField";
  Header header;
  Vector3 magnetic_field;  // [T]
  std::array<double, 9> magnetic_field_covariance{};
  REHEARSE_FIELDS(header, magnetic_field, magnetic_field_covariance)
};

}  // namespace msg

namespace {

constexpr ElementGroup magnetic_field_groups[] = {{"magnetic_field", "T", "xyz"}};

std::array<double*, 3> places_of_magnetic_field(msg::MagneticField& message) {
  return {&message.magnetic_field.x, &message.magnetic_field.y, &message.magnetic_field.z};
}

constexpr LogInput magnetic_field_input{.content = LogInput::Content::numbers,
                                        .key = "magnetometers",
                                        .form = "magnetometer_source",
                                        .owner = "a magnetometer",
                                        .devices = "magnetometers",
                                        .messages = "a MagneticField"};
constexpr DeviceMeasurement magnetic_field_measurement{.log = magnetic_field_input};

}  // namespace

const ChannelForm magnetic_field_kind{
    .level = ChannelForm::Level::owner,
    .segment = "magnetic_field",
    .type = msg::MagneticField::type_name,
    .schema = msg::schema_text<msg::MagneticField>,
    .stage = Stage::sensors,
    .groups = magnetic_field_groups,
    .has_fixed_elements = true,
    .is_state = true,
    .make_rows = number_rows<msg::MagneticField, places_of_magnetic_field, ChannelKind::magnetic_field>,
    .numbers = &number_message<msg::MagneticField, places_of_magnetic_field>,
    .measurement = &magnetic_field_measurement};

}  // namespace rehearse
