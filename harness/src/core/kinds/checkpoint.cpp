// The complete state of the simulation, at intervals.
#include "kind.h"

namespace rehearse {

const ChannelForm checkpoint_kind{.level = ChannelForm::Level::run,
                                  .segment = "checkpoint",
                                  .type = msg::Checkpoint::type_name,
                                  .schema = msg::schema_text<msg::Checkpoint>,
                                  .stage = Stage::physics,
                                  .has_series = false};

}  // namespace rehearse
