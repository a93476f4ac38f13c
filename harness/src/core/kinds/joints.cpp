// The joints of a body, or those on a side of a controller.
#include "joint_rows.h"

namespace rehearse {

const ChannelForm joints_kind{
    .level = ChannelForm::Level::body,
    .segment = "joints",
    .type = msg::JointState::type_name,
    .schema = msg::schema_text<msg::JointState>,
    .stage = Stage::physics,
    .groups = joint_groups,
    .is_state = true,
    // They share chunks with the inputs that repeat them: in separate chunks, a humanoid's recording is 29 % larger.
    .chunks = mcap::numbers,
    .make_rows = [](TraceChannel& channel, const std::string&) {
      return joint_rows(channel, {"/q", "/dq", "/u"});
    }};

}  // namespace rehearse
