// The elements and attributes of a URDF document that the loader reads; the rest is reported in a note and removed.
#pragma once

#include "urdf_findings.h"

#include <string_view>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

/// True for the name of an element in the table of known elements.
bool is_read(std::string_view element);

/// Compares <robot> with the table of known elements. Unknown elements, attributes and stray text are reported as
/// ignored and removed, so that the document contains only what the readers read. A second element where only one is
/// allowed is an error. <gazebo> blocks, sensors, transmissions and the content of <geometry> are left unchanged for
/// their own readers.
void prune_to_schema(tinyxml2::XMLElement& robot, Findings& findings);

}  // namespace rehearse::urdf
