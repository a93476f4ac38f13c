// plant_code(): identifies the code of Rehearse on which the bits of a simulation depend.
#pragma once

#include <string>

namespace rehearse {

/// SHA-256 of the object code of the rooms that load, simulate, draw, command and record: equal for equal code, also
/// after a new build. The build makes the source of this function (tools/cmake/plant_code.cmake).
std::string plant_code();

}  // namespace rehearse
