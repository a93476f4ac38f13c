// A Referenced that can be copied through a pointer to its base class.
#pragma once

#include "Referenced.h"

namespace cnoid {

class CloneMap;

class CNOID_GENERAL_EXPORT ClonableReferenced : public Referenced {
 public:
  ~ClonableReferenced() override;

  /// A new copy; the caller becomes its first owner. The map is part of Choreonoid's signature; Rehearse always passes
  /// null.
  virtual Referenced* doClone(CloneMap* cloneMap) const = 0;
};

}  // namespace cnoid
