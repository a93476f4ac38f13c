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
  /// Reads every <material> of the robot. One that only refers to a name takes the last definition before it, else the
  /// first one after it.
  Materials(const tinyxml2::XMLElement& robot, Findings& findings);

  /// The colour of a <visual>; none if it has no material or that has no colour.
  std::optional<Color> of(const tinyxml2::XMLElement& visual) const;

 private:
  std::map<const tinyxml2::XMLElement*, Color> colors_;  // by <material>; only looked up, never walked
};

}  // namespace rehearse::urdf
