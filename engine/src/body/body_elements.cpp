#include "body_elements.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"

namespace rehearse::body {
namespace {

bool is_one_of(std::string_view type, std::initializer_list<std::string_view> types) {
  return std::ranges::find(types, type) != types.end();
}

/// Devices of Choreonoid's plugins, and the words for a message.
struct Foreign {
  std::string_view begin;  // of the type
  std::string_view needs;
};
constexpr Foreign foreign[] = {{"AGX", "AGX Dynamics"},
                               {"Px", "PhysX"},
                               {"Smoke", "Choreonoid's effects"},
                               {"Fire", "Choreonoid's effects"},
                               {"Fountain", "Choreonoid's effects"},
                               {"Rain", "Choreonoid's effects"},
                               {"Snow", "Choreonoid's effects"},
                               {"Livox", "Choreonoid's Livox plugin"},
                               {"CompetitorMarker", "a plugin of the WRS"},
                               {"StdActionController", "a plugin of its author"}};

Inertial transformed(Inertial body, const Eigen::Affine3d& place) {
  body.center = place * body.center;
  body.inertia = place.linear() * body.inertia * place.linear().transpose();
  return body;
}

}  // namespace

void read_elements(Files& files, Document& document, const YamlNode& elements, Contents& contents) {
  ElementReader(files, document, contents).read_all(elements, {&document});
}

void ElementReader::read_all(const YamlNode& elements, const Place& place) {
  if (place.depth > max_body_depth) return place.document->error(elements, "its elements nest too deep");
  if (elements.kind == YamlNode::Kind::list) {
    for (const YamlNodePtr& item : elements.items) read_typed(*item, place);
    return;
  }
  if (elements.kind == YamlNode::Kind::empty) return;
  Mapping by_type(elements, "elements", *place.document);
  if (!by_type.is_map()) return;
  note_replaced(elements);
  if (by_type.find({"type"}) != nullptr) return read_typed(elements, place);
  for (const auto& [type, node] : by_type.unread()) read(type, *node, place);
}

/// Of two RigidBody keys in one mapping the second replaces the first, with its mass.
void ElementReader::note_replaced(const YamlNode& elements) {
  const YamlNode* first = nullptr;
  for (const YamlNodePtr& key : elements.keys) {
    if (key->text != "RigidBody") continue;
    if (first != nullptr) contents_.replaced_body = {first->line, key->line};
    first = key.get();
  }
}

void ElementReader::read_typed(const YamlNode& node, const Place& place) {
  Mapping keys(node, "an element", *place.document);
  if (!keys.is_map()) return;
  const auto type = keys.text({"type"});
  if (!type || type->empty())
    return place.document->error(node, "an element has no type", "type: Shape, Transform, RigidBody and so on");
  read(*type, node, place);
}

void ElementReader::read(const std::string& type, const YamlNode& node, const Place& place) {
  if (++files_.elements > max_body_elements) {
    if (files_.elements == max_body_elements + 1)
      place.document->error(node, fmt::format("it has more than {} elements", max_body_elements));
    return;
  }
  Mapping keys(node, type.empty() ? "an element" : "a " + printable(type), *place.document);
  if (!keys.is_map()) return;
  const auto own_type = keys.text({"type"});
  if (own_type && *own_type != type)
    return place.document->error(
        node, fmt::format("a node of the type {} is under the key {}", in_quotes(*own_type), in_quotes(type)));
  keys.find({"name"});
  keys.find({"is_optional", "isOptional"});
  if (!read_known(type, keys, place)) refuse(type, keys, place);
}

bool ElementReader::read_known(const std::string& type, Mapping& keys, const Place& place) {
  if (type == "Skip" || type == "skip") return true;
  if (is_one_of(type,
                {"LineSet", "Text", "DirectionalLight", "PerspectiveCamera", "OrthographicCamera", "Fog", "Node"})) {
    place.document->note(keys.node(), fmt::format("the node {} concerns looks only; it is left out", in_quotes(type)));
    return true;
  }
  Place below = place;
  if (type == "Shape") {
    read_shape(keys, place);
  } else if (type == "Resource") {
    read_resource(keys, place);
  } else if (is_one_of(type, {"Visual", "Collision"})) {
    read_visual_or_collision(type, keys, place);
  } else if (is_one_of(type, {"Group", "Transform", "RigidBody"})) {
    if (type != "Group") below.transform = place.transform * keys.transform();
    if (type == "RigidBody") read_rigid_body(keys, below);
    read_below(keys, below);
  } else {
    return read_device(type, keys, place);
  }
  keys.finish({"rotation", "translation", "scale", "density", "division_number", "divisionNumber"});
  return true;
}

void ElementReader::refuse(const std::string& type, Mapping& keys, const Place& place) {
  Document& document = *place.document;
  const bool is_optional = keys.flag({"is_optional", "isOptional"}).value_or(false);
  for (const auto& [begin, needs] : foreign) {
    if (!type.starts_with(begin)) continue;
    const std::string message = fmt::format("{} needs {}; it is left out", printable(type), needs);
    if (is_optional)
      document.note(keys.node(), message);
    else
      document.warning(keys.node(), message);
    Place below = place;
    below.transform = place.transform * keys.transform();
    return read_below(keys, below);
  }
  const bool is_allowed = files_.options().allow_unknown_devices;
  if (is_optional) {
    document.note(keys.node(), fmt::format("the optional element {} isn't known; it is left out", in_quotes(type)));
  } else if (!is_allowed) {
    document.error(keys.node(), fmt::format("the element type {} isn't known", in_quotes(type)),
                   "if it is a device of a plugin: --allow-unknown-devices, or allow_unknown_devices: true in a "
                   "scenario, leaves it out");
  } else {
    const std::string name = keys.text({"name"}).value_or("");
    document.warning(keys.node(), fmt::format("the device {}{} isn't known; it is left out", in_quotes(type),
                                              name.empty() ? "" : " " + in_quotes(name)));
    Place below = place;
    below.transform = place.transform * keys.transform();
    read_below(keys, below);
  }
}

void ElementReader::read_below(Mapping& keys, const Place& place) {
  Place below = place;
  ++below.depth;
  if (const YamlNode* elements = keys.find({"elements"})) read_all(*elements, below);
}

void ElementReader::read_rigid_body(Mapping& keys, const Place& place) {
  Inertial body;
  body.center = keys.vector({"center_of_mass", "centerOfMass"}).value_or(Eigen::Vector3d::Zero());
  body.mass = keys.soft_number({"mass"}, 0.0);
  if (body.mass < 0.0) {
    place.document->error(keys.node(), fmt::format("a RigidBody has a mass of {} kg", body.mass));
    body.mass = 0.0;
  }
  if (const YamlNode* inertia = keys.find({"inertia"}))
    body.inertia = read_inertia(*inertia, *place.document).value_or(Eigen::Matrix3d::Zero());
  contents_.bodies.push_back(transformed(body, place.transform));
}

void ElementReader::read_visual_or_collision(const std::string& type, Mapping& keys, Place place) {
  const bool is_visual = type == "Visual";
  if (is_visual ? place.is_collision : place.is_visual)
    return place.document->error(keys.node(),
                                 fmt::format("a {} is within a {}", type, is_visual ? "Collision" : "Visual"));
  (is_visual ? place.is_visual : place.is_collision) = true;
  place.transform = place.transform * keys.transform();
  ++place.depth;
  if (const YamlNode* node = keys.find({"resource"})) {
    Mapping resource(*node, "a Resource", *place.document);
    if (resource.is_map()) read_resource(resource, place);
    resource.find({"type", "name"});
    resource.finish();
  }
  if (const YamlNode* node = keys.find({"shape"})) {
    Mapping shape(*node, "a Shape", *place.document);
    if (shape.is_map()) read_shape(shape, place);
    shape.find({"type", "name"});
    shape.finish();
  }
  if (const YamlNode* elements = keys.find({"elements"})) read_all(*elements, place);
}

}  // namespace rehearse::body
