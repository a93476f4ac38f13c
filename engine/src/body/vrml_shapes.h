// Shapes and transforms of a VRML97 file as elements of a .body.
#pragma once

#include <vector>

#include "mesh/vrml_tree.h"
#include "yaml/yaml_tree.h"
#include "yaml_writer.h"

namespace rehearse::body {

/// Adds translation and rotation of the node. A rotation whose axis is zero is none, as in VRML.
void add_pose(const VrmlNode& node, MapWriter& to);

/// The elements below a Transform: one element, or four within each other if it has a centre or turned axes of scale.
YamlNodePtr transform_element(const VrmlNode& node, std::vector<YamlNodePtr> below);

/// The element of a Shape or an Inline; null if it has no faces.
YamlNodePtr shape_element(const VrmlNode& node);

}  // namespace rehearse::body
