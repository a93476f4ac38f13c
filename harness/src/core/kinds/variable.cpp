// A variable that a controller shows.
#include "channel_name.h"
#include "rows.h"

namespace rehearse {

const ChannelForm variable_kind{
    .level = ChannelForm::Level::variable,
    .segment = "",
    .type = msg::Float64::type_name,
    .schema = msg::schema_text<msg::Float64>,
    .stage = Stage::controller,
    // the element is the last segment of the topic
    .make_rows =
        [](TraceChannel& channel, const std::string& owner) {
          return rows_of<msg::Float64>(channel,
                                       [element = topic_segment(owner)](const msg::Float64& message, RowWriter& row) {
                                         row.put(element, message.data);
                                       });
        },
    .has_rows_by_topic = true};

}  // namespace rehearse
