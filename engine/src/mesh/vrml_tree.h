// A VRML97 file (ISO/IEC 14772-1) as a tree of nodes. Of PROTO only the nodes of OpenHRP's bodies are read: Humanoid,
// Joint, Segment, sensors and a few more. Their fields have the defaults that the file declares; their bodies, which
// repeat the fields, are passed over. A node of another PROTO is an error.
#pragma once

#include <rehearse/diagnostic.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct VrmlNode;
using VrmlNodePtr = std::shared_ptr<const VrmlNode>;

/// The value of a field: the text determines its type.
struct VrmlValue {
  std::vector<double> numbers;  // TRUE is 1, FALSE 0
  std::vector<std::string> texts;
  std::vector<VrmlNodePtr> nodes;
};

struct VrmlNode {
  std::string type;
  std::string name;  // of its DEF; empty: none
  std::map<std::string, VrmlValue> fields;
  int line = 0;
  bool is_of_proto = false;  // its type is declared by a PROTO of the file

  /// The field, or null.
  const VrmlValue* find(const std::string& field) const;
  /// The first node in the field, or null.
  const VrmlNode* node(const std::string& field) const;
  /// The field's numbers, if there are as many; else `otherwise`.
  std::vector<double> numbers(const std::string& field, std::vector<double> otherwise) const;
};

/// The nodes below a grouping node: Transform, Group, Switch, LOD (its first level), Humanoid, Joint, Segment and
/// others.
std::vector<VrmlNodePtr> children_of(const VrmlNode& node);

/// The nodes on the file's top level. The header may be missing. An error, with its line, if the text isn't VRML97.
Result<std::vector<VrmlNodePtr>> parse_vrml(std::string_view text);

}  // namespace rehearse
