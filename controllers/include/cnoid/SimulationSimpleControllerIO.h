// SimulationSimpleControllerIO: former names of no-delay mode; sources reach them by a cast of their IO object.
#pragma once

#include "SimpleControllerIO.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT SimulationSimpleControllerIO : public SimpleControllerIO {
 public:
  ~SimulationSimpleControllerIO() override;

  [[deprecated("Use isNoDelayMode.")]] virtual bool isImmediateMode() const;
  [[deprecated("Use setNoDelayMode.")]] virtual void setImmediateMode(bool on);
};

}  // namespace cnoid
