// LinkGroup: the links of a body in named groups, as the model file arranges them (its key link_group).
#pragma once

#include "Config.h"
#include "Referenced.h"

#include <string>
#include <variant>
#include <vector>

namespace cnoid {

class Body;
class Listing;
class LinkGroup;
using LinkGroupPtr = ref_ptr<LinkGroup>;

class CNOID_GENERAL_EXPORT LinkGroup : public Referenced {
 public:
  /// The group "Whole Body". Without link_group (linkGroup) in Body::info() it contains all links. A name that no link
  /// has is left out.
  static LinkGroup* create(const Body* body);
  LinkGroup(const LinkGroup&) = delete;
  LinkGroup& operator=(const LinkGroup&) = delete;

  const std::string& name() const { return name_; }
  void setName(const std::string& name) { name_ = name; }

  int numElements() const { return static_cast<int>(elements_.size()); }
  /// An element is a group or a link. The index is not checked.
  bool checkIfGroup(int index) const { return std::holds_alternative<LinkGroupPtr>(element(index)); }
  bool checkIfLink(int index) const { return std::holds_alternative<int>(element(index)); }
  /// Throws std::bad_variant_access if the element is a link, or a group.
  LinkGroup* group(int index) const { return std::get<LinkGroupPtr>(element(index)); }
  int linkIndex(int index) const { return std::get<int>(element(index)); }
  /// The first group of that name at any depth below this one; null if there is none.
  LinkGroup* findSubGroup(const std::string& name) const;

 private:
  using Element = std::variant<LinkGroupPtr, int>;

  LinkGroup() = default;
  const Element& element(int index) const { return elements_[static_cast<std::size_t>(index)]; }
  void read(const Body& body, const Listing& links);

  std::string name_;
  std::vector<Element> elements_;
};

}  // namespace cnoid
