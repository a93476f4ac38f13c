// The measurement of a force sensor; on a side of a controller the external force on a link.
#include <cnoid/ForceSensor>

#include "number_message.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup wrench_groups[] = {{"force", "N", "xyz"}, {"torque", "N·m", "xyz"}};

auto places_of_wrench(msg::WrenchStamped& message) { return numbers_in(message.wrench.force, message.wrench.torque); }

constexpr LogInput wrench_input{.content = LogInput::Content::numbers,
                                .key = "wrenches",
                                .form = "wrench_source",
                                .owner = "a wrench",
                                .devices = "force sensors",
                                .messages = "a WrenchStamped",
                                .fields = "wrench/"};
constexpr DeviceMeasurement wrench_measurement{
    .log = wrench_input, .make = [](const Device&) -> cnoid::Device* { return new cnoid::ForceSensor; }};

}  // namespace

const ChannelForm wrench_kind{.level = ChannelForm::Level::owner,
                              .segment = "wrench",
                              .type = msg::WrenchStamped::type_name,
                              .schema = msg::schema_text<msg::WrenchStamped>,
                              .stage = Stage::sensors,
                              .groups = wrench_groups,
                              .has_fixed_elements = true,
                              .is_state = true,
                              .of_link = ChannelForm::OfLink::on_sides,
                              .make_rows = number_rows<msg::WrenchStamped, places_of_wrench, ChannelKind::wrench>,
                              .numbers = &number_message<msg::WrenchStamped, places_of_wrench>,
                              .read_link =
                                  [](mcap::Bytes bytes, int link, BodyObservation& body) {
                                    msg::WrenchStamped message;
                                    CdrReader reader(bytes);
                                    if (!msg::decode(reader, message)) return false;
                                    body.external.resize(body.links.size());
                                    body.external[static_cast<std::size_t>(link)] = {
                                        eigen_vector(message.wrench.force), eigen_vector(message.wrench.torque)};
                                    return true;
                                  },
                              .measurement = &wrench_measurement};

}  // namespace rehearse
