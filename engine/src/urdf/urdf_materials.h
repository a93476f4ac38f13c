// Colours by name. A name may be used before it is defined, and may be defined inside any link.
#pragma once

#include <rehearse/model.h>

#include "urdf_findings.h"

#include <map>
#include <optional>

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

class Materials {
 public:
  /// Reads every <material> of the robot. A <material> that only refers to a name has the colour of the last definition
  /// before it, else of the first definition after it.
  Materials(const tinyxml2::XMLElement& robot, Findings& findings);

  /// The colour of a <visual>; nullopt if it has no material or its material has no colour.
  std::optional<Color> of(const tinyxml2::XMLElement& visual) const;

 private:
  std::map<const tinyxml2::XMLElement*, Color> colors_;  // by <material>; never iterated, since keys are addresses
};

}  // namespace rehearse::urdf
