// The costs of a controller's calls of control(), if the run counts them.
#include <algorithm>

#include "cost_fields.h"
#include "kind.h"
#include "rows.h"

namespace rehearse {
namespace {

/// A group for each field: the series are BODY/CONTROLLER/cost/allocations and so on.
constexpr ElementGroup cost_groups[] = {
    {"cost/allocations", ""},  {"cost/allocated_bytes", "B"}, {"cost/releases", ""},      {"cost/locks", ""},
    {"cost/system_calls", ""}, {"cost/exceptions", ""},       {"cost/message_bytes", "B"}};
static_assert(std::ranges::equal(cost_groups, cost_fields, [](const ElementGroup& group, const CostField& field) {
  return group.name.substr(std::string_view("cost/").size()) == field.name && group.unit == field.unit;
}));

}  // namespace

const ChannelForm cost_kind{
    .level = ChannelForm::Level::owner,  // the owner is the controller
    .segment = "cost",
    .type = msg::ControlCost::type_name,
    .schema = msg::schema_text<msg::ControlCost>,
    .stage = Stage::costs,
    .groups = cost_groups,
    .has_fixed_elements = true,
    .chunks = mcap::numbers,
    .make_rows =
        [](TraceChannel& channel, const std::string&) {
          return rows_of<msg::ControlCost>(channel, [](const msg::ControlCost& cost, RowWriter& row) {
            for (std::size_t i = 0; i < std::size(cost_fields); ++i)
              row.put(cost_groups[i].name, CellKind::unsigned_integer, cost.*cost_fields[i].count);
          });
        },
    .has_rows_by_topic = true};

}  // namespace rehearse
