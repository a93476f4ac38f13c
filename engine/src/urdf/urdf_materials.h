// Colours and textures by name. A name may be used before it is defined, and may be defined inside any link.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

#include <map>
#include <memory>
#include <optional>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

class Meshes;

/// The colour and texture that a material states.
struct Appearance {
  std::optional<Color> color;
  std::shared_ptr<const Texture> texture;  // null: none

  bool says_something() const { return color || texture; }
};

class Materials {
 public:
  /// Reads every <material> of the robot. A <material> that only refers to a name has the appearance of the last
  /// definition before it, else of the first definition after it.
  Materials(const tinyxml2::XMLElement& robot, Meshes& meshes, Findings& findings);

  /// The colour and texture of a <visual>; neither if it has no material or its material states none.
  Appearance of(const tinyxml2::XMLElement& visual) const;

 private:
  std::map<const tinyxml2::XMLElement*, Appearance>
      appearances_;  // by <material>; never iterated, since keys are addresses
};

}  // namespace rehearse::urdf
