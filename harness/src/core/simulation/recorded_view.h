// A picture of a recording at a tick. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <vector>

namespace rehearse {

/// A PNG for a list of reports: the bodies of the scenario as the recording has them at a tick, from the default
/// viewpoint. A body that the recording lacks is drawn at its start. Empty if nothing can be drawn, or in a process
/// that was forked after the first drawing, where the renderer's threads don't exist.
std::vector<std::uint8_t> thumbnail_of(const Scenario& scenario, const Trace& recording, std::int64_t tick);

}  // namespace rehearse
