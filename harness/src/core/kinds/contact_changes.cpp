// Two links begin or end to touch.
#include "kind.h"

namespace rehearse {

const ChannelForm contact_changes_kind{.level = ChannelForm::Level::run,
                                       .segment = "contacts",
                                       .type = msg::ContactChange::type_name,
                                       .schema = msg::schema_text<msg::ContactChange>,
                                       .stage = Stage::physics,
                                       .has_series = false};

}  // namespace rehearse
