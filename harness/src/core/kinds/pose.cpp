// The pose of a link in the world.
#include "number_message.h"
#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr ElementGroup pose_groups[] = {{"position", "m", "xyz"}, {"orientation", "quaternion", "xyzw"}};

auto places_of_pose(msg::PoseStamped& message) { return numbers_in(message.pose.position, message.pose.orientation); }

}  // namespace

const ChannelForm pose_kind{.level = ChannelForm::Level::owner,
                            .segment = "pose",
                            .type = msg::PoseStamped::type_name,
                            .schema = msg::schema_text<msg::PoseStamped>,
                            .stage = Stage::physics,
                            .groups = pose_groups,
                            .has_fixed_elements = true,
                            .is_state = true,
                            .of_link = ChannelForm::OfLink::always,
                            .make_rows = number_rows<msg::PoseStamped, places_of_pose, ChannelKind::pose>,
                            .numbers = &number_message<msg::PoseStamped, places_of_pose>,
                            .read_link = [](mcap::Bytes bytes, int link, BodyObservation& body) {
                              msg::PoseStamped message;
                              CdrReader reader(bytes);
                              if (!msg::decode(reader, message)) return false;
                              const auto& [position, orientation] = message.pose;
                              body.links[link].position = eigen_vector(position);
                              body.links[link].rotation = {orientation.w, orientation.x, orientation.y, orientation.z};
                              return true;
                            }};

}  // namespace rehearse
