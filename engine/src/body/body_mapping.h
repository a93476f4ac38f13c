// The keys of one mapping of a .body file, read as Choreonoid reads them.
#pragma once

#include <Eigen/Geometry>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body_document.h"

namespace rehearse::body {

/// Spellings of a key; the first one that the mapping contains counts.
using Names = std::initializer_list<std::string_view>;

/// The longest number at the beginning of a text; nothing if there is none. `is_whole`: nothing follows it.
std::optional<double> leading_number(std::string_view text, bool& is_whole);

/// An axis-angle rotation, or a product of several from left to right.
std::optional<Eigen::Matrix3d> read_rotation(const YamlNode& node, Document& document);
/// [x y z], or the sum of several.
std::optional<Eigen::Vector3d> read_translation(const YamlNode& node, Document& document);
/// A list of numbers; `size`: their count, 0: any count. Else an error, and nothing.
std::optional<std::vector<double>> read_numbers(const YamlNode& node, std::size_t size, std::string_view label,
                                                Document& document);
std::optional<double> read_number(const YamlNode& node, std::string_view label, Document& document);

/// Visits the entries by the alphabet, each key once: merges (<<) are resolved, and if a key appears twice, the last
/// entry counts, with a warning.
class Mapping {
 public:
  /// `kind`: for messages, as "a link". An error if the node isn't a mapping; then it is empty.
  Mapping(const YamlNode& node, std::string_view kind, Document& document);

  bool is_map() const { return node_.kind == YamlNode::Kind::map; }
  const YamlNode& node() const { return node_; }
  Document& document() const { return document_; }

  /// The value, or null if there is none or it is empty. The key counts as read.
  const YamlNode* find(Names names);

  /// "An error, and nothing": a value that is present and wrong is an error.
  std::optional<double> number(Names names);
  std::optional<Eigen::Vector3d> vector(Names names);
  std::optional<std::vector<double>> numbers(Names names, std::size_t size = 0);
  std::optional<std::string> text(Names names);
  std::optional<bool> flag(Names names);
  /// In the unit of the file; returned in radians.
  std::optional<double> angle(Names names);

  /// A number; `otherwise`, with a warning, if the value isn't one (Choreonoid takes its default without a warning).
  double soft_number(Names names, double otherwise);
  double soft_angle(Names names, double otherwise);

  /// T R S of translation, rotation and scale.
  Eigen::Affine3d transform(bool has_scale = true);

  /// Entries whose keys were not read.
  std::vector<std::pair<std::string, const YamlNode*>> unread() const;
  /// Reports these entries: a warning for a key that resembles a requested key, else a note. Call it last.
  void finish(const std::vector<std::string_view>& without_effect = {});

  double radians(double angle) const;

 private:
  struct Entry {
    const YamlNode* key;
    const YamlNode* value;
    bool is_read = false;
  };
  void take(const YamlNode& map, int depth);
  void merge(const YamlNode& value, int depth);

  const YamlNode& node_;
  std::string kind_;
  Document& document_;
  std::map<std::string, Entry, std::less<>> entries_;
  std::vector<std::string> asked_;
};

}  // namespace rehearse::body
