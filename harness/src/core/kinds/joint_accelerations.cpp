// The accelerations of the joints on a side of a controller.
#include "joint_rows.h"

namespace rehearse {
namespace {

constexpr ElementGroup joint_acceleration_groups[] = {{"ddq", "rad/s²", {}, "m/s²"}};

}  // namespace

const ChannelForm joint_accelerations_kind{
    .level = ChannelForm::Level::body,
    .segment = "joint_accelerations",
    .type = msg::JointAccelerations::type_name,
    .schema = msg::schema_text<msg::JointAccelerations>,
    .stage = Stage::physics,
    .groups = joint_acceleration_groups,
    .is_state = true,
    .make_rows = [](TraceChannel& channel, const std::string&) { return joint_rows(channel, {"/ddq"}); }};

}  // namespace rehearse
