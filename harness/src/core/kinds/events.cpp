// Single events: a controller failed, a push began.
#include "kind.h"

namespace rehearse {

const ChannelForm events_kind{.level = ChannelForm::Level::run,
                              .segment = "events",
                              .type = msg::Event::type_name,
                              .schema = msg::schema_text<msg::Event>,
                              .stage = Stage::controller,
                              .has_series = false};

}  // namespace rehearse
