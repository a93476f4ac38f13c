// Timing: in which step of the world a controller's commands act.
#pragma once

namespace rehearse {

enum class Timing {
  same_step,  // of the tick in which they were given: no-delay mode
  next_step,  // one tick later: all others
};

}  // namespace rehearse
