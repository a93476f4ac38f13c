// What a controller reads, against what a map gives.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <vector>

#include "host/controller_host.h"
#include "log_map/log_map.h"
#include "log_replay.h"
#include "log_survey.h"

namespace rehearse {

/// Each quantity and device that a running controller reads and nothing in the map gives, with what would give it.
Diagnostics inputs_not_given(const ControllerHost& host, const Model& model, const LogMap& map,
                             const std::vector<MappedSource>& sources, const LogSurvey& survey);

/// A report as text by name, as a recording keeps it.
mcap::StringMap metadata_of(const LogTopicReport& topic);

}  // namespace rehearse
