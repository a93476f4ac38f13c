// Timing: the step of the world in which a controller's commands act.
#pragma once

namespace rehearse {

enum class Timing {
  same_step,  // the step of the tick of the commands: no-delay mode
  next_step,  // one tick later: all other controllers
};

}  // namespace rehearse
