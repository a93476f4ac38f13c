// Look: how a scene looks beside its bodies.
#pragma once

#include <rehearse/model.h>

namespace rehearse {

struct Look {
  Color sky{0.55f, 0.68f, 0.82f, 1.0f};  // what is seen where nothing is
};

}  // namespace rehearse
