// A stream that discards all output.
#pragma once

#include "Config.h"

#include <ostream>

namespace cnoid {

CNOID_GENERAL_EXPORT std::ostream& nullout();

}  // namespace cnoid
