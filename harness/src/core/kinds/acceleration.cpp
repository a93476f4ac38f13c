// The acceleration of a link, in world axes.
#include "number_message.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup acceleration_groups[] = {{"linear_acceleration", "m/s²", "xyz"},
                                                {"angular_acceleration", "rad/s²", "xyz"}};

auto places_of_acceleration(msg::AccelStamped& message) {
  return numbers_in(message.accel.linear, message.accel.angular);
}

}  // namespace

const ChannelForm acceleration_kind{
    .level = ChannelForm::Level::owner,
    .segment = "accel",
    .type = msg::AccelStamped::type_name,
    .schema = msg::schema_text<msg::AccelStamped>,
    .stage = Stage::physics,
    .groups = acceleration_groups,
    .has_fixed_elements = true,
    .is_state = true,
    .of_link = ChannelForm::OfLink::always,
    .make_rows = number_rows<msg::AccelStamped, places_of_acceleration, ChannelKind::acceleration>,
    .numbers = &number_message<msg::AccelStamped, places_of_acceleration>,
    .read_link = [](mcap::Bytes bytes, int link, BodyObservation& body) {
      msg::AccelStamped message;
      CdrReader reader(bytes);
      if (!msg::decode(reader, message)) return false;
      body.links[link].acceleration = eigen_vector(message.accel.linear);
      body.links[link].angular_acceleration = eigen_vector(message.accel.angular);
      return true;
    }};

}  // namespace rehearse
