// The information in a model file that the loader doesn't use: link groups, feet, and whatever its author added.
#pragma once

#include <rehearse/model.h>
#include <cnoid/ValueTree>

namespace rehearse {

/// Adds the top-level keys of a .body file to the information of a body, without `links`. Nothing for other formats.
void read_body_info(const Model& model, cnoid::Mapping& info);

}  // namespace rehearse
