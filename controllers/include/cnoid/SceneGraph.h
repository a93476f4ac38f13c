// The names of scene nodes, for sources that include this header. Rehearse shows controllers no scene.
#pragma once

#include "EigenTypes.h"
#include "Referenced.h"

namespace cnoid {

class SgObject;
class SgNode;
class SgGroup;
class SgTransform;
class SgPosTransform;
class SgShape;
class SgMesh;

}  // namespace cnoid
