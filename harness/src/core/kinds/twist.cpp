// The velocity of a link, in world axes.
#include "number_message.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup twist_groups[] = {{"linear", "m/s", "xyz"}, {"angular", "rad/s", "xyz"}};

auto places_of_twist(msg::TwistStamped& message) { return numbers_in(message.twist.linear, message.twist.angular); }

}  // namespace

const ChannelForm twist_kind{.level = ChannelForm::Level::owner,
                             .segment = "twist",
                             .type = msg::TwistStamped::type_name,
                             .schema = msg::schema_text<msg::TwistStamped>,
                             .stage = Stage::physics,
                             .groups = twist_groups,
                             .has_fixed_elements = true,
                             .is_state = true,
                             .of_link = ChannelForm::OfLink::always,
                             .make_rows = number_rows<msg::TwistStamped, places_of_twist, ChannelKind::twist>,
                             .numbers = &number_message<msg::TwistStamped, places_of_twist>,
                             .read_link = [](mcap::Bytes bytes, int link, BodyObservation& body) {
                               msg::TwistStamped message;
                               CdrReader reader(bytes);
                               if (!msg::decode(reader, message)) return false;
                               body.links[link].velocity = eigen_vector(message.twist.linear);
                               body.links[link].angular_velocity = eigen_vector(message.twist.angular);
                               return true;
                             }};

}  // namespace rehearse
