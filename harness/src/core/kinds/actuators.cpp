// The actuators of a body: the motion of their rotors, and the efforts of their motors.
#include "joint_rows.h"

namespace rehearse {

const ChannelForm actuators_kind{.level = ChannelForm::Level::body,
                                 .segment = "actuators",
                                 .type = msg::JointState::type_name,
                                 .schema = msg::schema_text<msg::JointState>,
                                 .stage = Stage::physics,
                                 .groups = joint_groups,
                                 .is_state = true,
                                 .make_rows = [](TraceChannel& channel, const std::string&) {
                                   return joint_rows(channel, {"/q", "/dq", "/u"});
                                 }};

}  // namespace rehearse
