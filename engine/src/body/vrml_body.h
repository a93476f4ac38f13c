// A body in VRML97 with the PROTOs of OpenHRP, as the document that a .body file of the same meaning has.
#pragma once

#include <rehearse/diagnostic.h>

#include <string_view>

#include "yaml/yaml_tree.h"

namespace rehearse::body {

/// True if the file is VRML by its name or its first line, which some files lack.
bool is_vrml(std::string_view name, std::string_view text);

/// The document of the Humanoid in the file: format version 1.0, angles in radians, lines as in the file. Each Joint is
/// a link with the name of its DEF; its Segments are rigid bodies with shapes, its sensors are devices. Inline files
/// are mesh resources. An error, with its line, if the text isn't VRML97, or without exactly one Humanoid with one
/// Joint.
Result<YamlNodePtr> body_of_vrml(std::string_view text);

}  // namespace rehearse::body
