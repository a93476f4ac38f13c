#include "vrml_shapes.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace rehearse::body {
namespace {

std::vector<double> negated(std::vector<double> numbers, std::size_t from) {
  for (std::size_t i = from; i < numbers.size(); ++i) numbers[i] = -numbers[i];
  return numbers;
}

bool has_axis(const std::vector<double>& rotation) {
  return rotation[0] * rotation[0] + rotation[1] * rotation[1] + rotation[2] * rotation[2] > 1e-24;
}

YamlNodePtr placed(const std::vector<double>& translation, const std::vector<double>& rotation,
                   const std::vector<double>& scale, std::vector<YamlNodePtr> below, int line) {
  MapWriter element(line);
  element.add("type", text_node("Transform", line));
  element.add("translation", numbers_node(translation, line));
  if (has_axis(rotation)) element.add("rotation", numbers_node(rotation, line));
  element.add("scale", numbers_node(scale, line));
  element.add("elements", list_node(std::move(below), line));
  return element.node();
}

/// Copies fields of numbers that have the same name in a .body.
void copy(const VrmlNode& node, std::initializer_list<std::string_view> fields, MapWriter& to) {
  for (const std::string_view field : fields)
    if (const VrmlValue* value = node.find(std::string(field)))
      to.add(field, value->numbers.size() == 1 ? number_node(value->numbers[0], node.line)
                                               : numbers_node(value->numbers, node.line));
}

/// A size that VRML and .body files have different defaults for.
void add_size(const VrmlNode& node, const char* field, const char* key, double otherwise, MapWriter& to) {
  to.add(key, number_node(node.numbers(field, {otherwise})[0], node.line));
}

/// The faces; the other way round if their front is clockwise.
void add_faces(const VrmlNode& node, MapWriter& to) {
  const VrmlNode* points = node.node("coord");
  const VrmlValue* vertices = points == nullptr ? nullptr : points->find("point");
  const VrmlValue* faces = node.find("coordIndex");
  if (vertices == nullptr || faces == nullptr) return;
  std::vector<double> indices = faces->numbers;
  if (node.numbers("ccw", {1.0})[0] == 0.0) {
    for (auto begin = indices.begin(); begin != indices.end();) {
      const auto end = std::ranges::find_if(begin, indices.end(), [](double index) { return index < 0.0; });
      std::reverse(begin, end);
      begin = end == indices.end() ? end : end + 1;
    }
  }
  to.add("vertices", numbers_node(vertices->numbers, node.line));
  to.add("faces", numbers_node(indices, node.line));
  copy(node, {"creaseAngle"}, to);
  if (node.node("color") != nullptr) to.add("color", text_node("of the file", node.line));  // the load report has it
}

YamlNodePtr geometry_of(const VrmlNode& node) {
  MapWriter geometry(node.line);
  geometry.add("type", text_node(node.type, node.line));
  if (node.type == "Box") {
    geometry.add("size", numbers_node(node.numbers("size", {2, 2, 2}), node.line));
  } else if (node.type == "Sphere") {
    add_size(node, "radius", "radius", 1.0, geometry);
  } else if (node.type == "Cylinder") {
    add_size(node, "radius", "radius", 1.0, geometry);
    add_size(node, "height", "height", 2.0, geometry);
  } else if (node.type == "Cone") {
    add_size(node, "bottomRadius", "radius", 1.0, geometry);
    add_size(node, "height", "height", 2.0, geometry);
  } else if (node.type == "IndexedFaceSet") {
    add_faces(node, geometry);
  } else if (node.type == "Extrusion") {
    copy(node, {"crossSection", "spine", "orientation", "scale", "creaseAngle"}, geometry);
    for (const char* cap : {"beginCap", "endCap"})
      geometry.add(cap, text_node(node.numbers(cap, {1.0})[0] != 0.0 ? "true" : "false", node.line));
  } else if (node.type == "ElevationGrid") {
    add_size(node, "xSpacing", "xSpacing", 1.0, geometry);
    add_size(node, "zSpacing", "zSpacing", 1.0, geometry);
    copy(node, {"xDimension", "zDimension", "height", "creaseAngle"}, geometry);
  } else {
    return nullptr;  // lines, points, text
  }
  return geometry.node();
}

YamlNodePtr appearance_of(const VrmlNode& node) {
  MapWriter appearance(node.line);
  if (const VrmlNode* material = node.node("material")) {
    MapWriter looks(node.line);
    looks.add("diffuse", numbers_node(material->numbers("diffuseColor", {0.8, 0.8, 0.8}), node.line));
    looks.add("transparency", number_node(material->numbers("transparency", {0.0})[0], node.line));
    appearance.add("material", looks.node());
  }
  if (node.node("texture") != nullptr) appearance.add("texture", text_node("of the file", node.line));
  return appearance.node();
}

}  // namespace

void add_pose(const VrmlNode& node, MapWriter& to) {
  to.add("translation", numbers_node(node.numbers("translation", {0, 0, 0}), node.line));
  const auto rotation = node.numbers("rotation", {0, 0, 1, 0});
  if (has_axis(rotation)) to.add("rotation", numbers_node(rotation, node.line));
}

YamlNodePtr transform_element(const VrmlNode& node, std::vector<YamlNodePtr> below) {
  const std::vector<double> none{0, 0, 0}, upright{0, 0, 1, 0}, whole{1, 1, 1};
  auto translation = node.numbers("translation", none);
  const auto rotation = node.numbers("rotation", upright), scale = node.numbers("scale", whole);
  const auto centre = node.numbers("center", none), stretch = node.numbers("scaleOrientation", upright);
  const bool is_plain = centre == none && (stretch[3] == 0.0 || !has_axis(stretch));
  if (is_plain) return placed(translation, rotation, scale, std::move(below), node.line);
  below = {placed(negated(centre, 0), upright, whole, std::move(below), node.line)};
  below = {placed(none, negated(stretch, 3), whole, std::move(below), node.line)};
  below = {placed(none, stretch, scale, std::move(below), node.line)};
  for (std::size_t i = 0; i < translation.size(); ++i) translation[i] += centre[i];
  return placed(translation, rotation, whole, std::move(below), node.line);
}

YamlNodePtr shape_element(const VrmlNode& node) {
  MapWriter element(node.line);
  if (node.type == "Inline") {
    const VrmlValue* urls = node.find("url");
    if (urls == nullptr || urls->texts.empty()) return nullptr;
    element.add("type", text_node("Resource", node.line));
    element.add("uri", text_node(urls->texts.front(), node.line));
    return element.node();
  }
  const VrmlNode* geometry = node.node("geometry");
  YamlNodePtr form = geometry == nullptr ? nullptr : geometry_of(*geometry);
  if (form == nullptr) return nullptr;
  element.add("type", text_node("Shape", node.line));
  if (const VrmlNode* appearance = node.node("appearance")) element.add("appearance", appearance_of(*appearance));
  element.add("geometry", std::move(form));
  return element.node();
}

}  // namespace rehearse::body
