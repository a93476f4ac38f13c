// Compares the inputs of a controller with the sources of a map.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <vector>

#include "host/controller_host.h"
#include "log_map/log_map.h"
#include "log_replay.h"
#include "log_survey.h"

namespace rehearse {

/// An error for each quantity and device that a running controller reads without a source in the map. It names the
/// sources that would provide it.
Diagnostics inputs_not_given(const ControllerHost& host, const Model& model, const LogMap& map,
                             const std::vector<MappedSource>& sources, const LogSurvey& survey);

/// A report as text by name, as stored in a recording.
mcap::StringMap metadata_of(const LogTopicReport& topic);

}  // namespace rehearse
