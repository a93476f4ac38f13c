// The tick at which the commands of a controller act, from its first change on.
#include "kind.h"
#include "rows.h"

namespace rehearse {
namespace {

constexpr ElementGroup delay_groups[] = {{"delay", "ticks"}};

}  // namespace

const ChannelForm delay_kind{
    .level = ChannelForm::Level::body,
    .segment = "delay",
    .type = msg::Float64::type_name,
    .schema = msg::schema_text<msg::Float64>,
    .stage = Stage::controller,
    .groups = delay_groups,
    .make_rows =
        [](TraceChannel& channel, const std::string&) {
          return rows_of<msg::Float64>(
              channel, [](const msg::Float64& message, RowWriter& row) { row.put("delay", message.data); });
        },
    .has_rows_by_topic = true};

}  // namespace rehearse
