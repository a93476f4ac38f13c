// draft_map: a first map from a log to a model, by topics, types, frames and the names of joints.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/model.h>

#include <string>

namespace rehearse {

/// The text of a map that LogMap reads, with a comment for each guess and for everything that has no source. Fails if
/// no topic fits the model.
Result<std::string> draft_map(mcap::Reader& log, const Model& model);

}  // namespace rehearse
