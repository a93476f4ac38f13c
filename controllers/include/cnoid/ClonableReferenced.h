// A Referenced that can make a copy of itself without being asked by its exact type.
#pragma once

#include "Referenced.h"

namespace cnoid {

class CloneMap;

class CNOID_GENERAL_EXPORT ClonableReferenced : public Referenced {
 public:
  ~ClonableReferenced() override;

  /// A new copy, owned by nobody yet. The map is part of Choreonoid's signature; Rehearse always passes null.
  virtual Referenced* doClone(CloneMap* cloneMap) const = 0;
};

}  // namespace cnoid
