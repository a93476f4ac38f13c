// The joints of a body as its sensors measure them, with noise.
#include "joint_rows.h"

namespace rehearse {

const ChannelForm measured_joints_kind{.level = ChannelForm::Level::body,
                                       .segment = "measured_joints",
                                       .type = msg::JointState::type_name,
                                       .schema = msg::schema_text<msg::JointState>,
                                       .stage = Stage::sensors,
                                       .groups = joint_groups,
                                       .is_state = true,
                                       .make_rows = [](TraceChannel& channel, const std::string&) {
                                         return joint_rows(channel, {"/q", "/dq", "/u"});
                                       }};

}  // namespace rehearse
