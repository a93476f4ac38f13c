// One message a tick: the hashes of the tick, and the results of the controllers.
#include "kind.h"
#include "rows.h"

namespace rehearse {

const ChannelForm tick_kind{.level = ChannelForm::Level::run,
                            .segment = "tick",
                            .type = msg::Tick::type_name,
                            .schema = msg::schema_text<msg::Tick>,
                            .stage = Stage::controller,
                            .stage_of_element =
                                [](std::string_view element) {
                                  if (element == "state_hash") return Stage::physics;
                                  return element == "input_hash" ? Stage::inputs : Stage::controller;
                                },
                            .make_rows =
                                [](TraceChannel& channel, const std::string&) {
                                  return rows_of<msg::Tick>(channel, [](const msg::Tick& tick, RowWriter& row) {
                                    row.put("tick", CellKind::signed_integer, static_cast<std::uint64_t>(tick.tick));
                                    row.put("state_hash", CellKind::unsigned_integer, tick.state_hash);
                                    row.put("input_hash", CellKind::unsigned_integer, tick.input_hash);
                                    row.put("output_hash", CellKind::unsigned_integer, tick.output_hash);
                                    std::string element;
                                    for (std::size_t i = 0; i < tick.controller_results.size(); ++i) {
                                      element = "controller_results/" + std::to_string(i);
                                      row.put(element, CellKind::boolean, tick.controller_results[i] ? 1 : 0);
                                    }
                                  });
                                }};

}  // namespace rehearse
