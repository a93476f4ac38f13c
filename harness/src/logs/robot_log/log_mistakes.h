// The mistakes of a map that only the messages of the log, or the controller, show.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <vector>

#include "core/host/controller_host.h"
#include "log_survey.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// Names that never occur, several names or sources of one joint, commands of which no message can be read.
Diagnostics mistakes_in_names(const std::vector<MappedSource>& sources, const LogSurvey& survey, const Model& model);

/// Fails if the log has none of the numbers that the controllers command; a remark names the missing ones.
Result<void> check_commands(const ControllerHost& host, const Model& model, const CommandSource& source,
                            const SourceSurvey& survey, Diagnostics& remarks);

/// An error for each quantity and device that a running controller reads without a source in the map. It names the
/// sources that would provide it.
Diagnostics inputs_not_given(const ControllerHost& host, const Model& model, const LogMap& map,
                             const std::vector<MappedSource>& sources, const LogSurvey& survey);

}  // namespace rehearse
