// What of a URDF document means something to us; the rest is named in a note and taken out.
#pragma once

#include "urdf_findings.h"

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

/// Walks <robot> along the table of known elements. Unknown elements, attributes and stray text are reported as ignored
/// and removed, so that what is left is all that anybody reads; an element that may stand once and stands twice is an
/// error. <gazebo> blocks, sensors, transmissions and the content of <geometry> are left as they are, for their own
/// readers.
void prune_to_schema(tinyxml2::XMLElement& robot, Findings& findings);

}  // namespace rehearse::urdf
