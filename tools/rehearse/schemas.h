// The JSON Schemas of Rehearse: of the files that people write, and of the objects that verbs print.
#pragma once

#include <vector>

#include "json_forms.h"

namespace rehearse::tool {

/// All schemas: first those of files, then those of objects. Each name is that of one schema.
std::vector<NamedForm> all_schemas();

}  // namespace rehearse::tool
