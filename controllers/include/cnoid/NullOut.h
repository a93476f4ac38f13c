// A stream that forgets what is written to it.
#pragma once

#include "Config.h"

#include <ostream>

namespace cnoid {

CNOID_GENERAL_EXPORT std::ostream& nullout();

}  // namespace cnoid
