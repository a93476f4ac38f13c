// The plant level of a recording, as partial acceptance asks for it.
#pragma once

#include <rehearse/partial_acceptance.h>

namespace rehearse::tool {

/// Feeds a recording's commands to the world, from checkpoint to checkpoint.
PlantCheck plant_check();

}  // namespace rehearse::tool
