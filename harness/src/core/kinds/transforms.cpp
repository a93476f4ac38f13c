// The poses of all links and the frames of all range sensors, at 30 Hz at most.
#include "number_message.h"

namespace rehearse {
namespace {

constexpr ElementGroup transform_groups[] = {{"position", "m", "xyz"}, {"orientation", "quaternion", "xyzw"}};

}  // namespace

const ChannelForm transforms_kind{
    .level = ChannelForm::Level::run,
    .segment = "tf",
    .type = msg::TFMessage::type_name,
    .schema = msg::schema_text<msg::TFMessage>,
    .stage = Stage::physics,
    .groups = transform_groups,
    .stage_of_element =
        [](std::string_view element) {
          return element.find("/scan/") == std::string_view::npos ? Stage::physics : Stage::sensors;
        },
    .make_rows =
        [](TraceChannel& channel, const std::string&) {
          return rows_of<msg::TFMessage>(channel, [](msg::TFMessage& message, RowWriter& row) {
            std::string prefix;
            for (msg::TransformStamped& t : message.transforms) {
              prefix = t.child_frame_id;
              prefix += '/';
              put_after(prefix, ChannelKind::transforms, numbers_in(t.transform.translation, t.transform.rotation),
                        row);
            }
          });
        }};

}  // namespace rehearse
