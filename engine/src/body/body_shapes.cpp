// Shapes: geometry, colour and place.
#include <fmt/format.h>

#include "base/text.h"
#include "body_elements.h"
#include "mesh/convex_hull.h"

namespace rehearse::body {
namespace {

/// Red, green and blue, each 0 to 1.
std::optional<Eigen::Vector3d> read_color(Mapping& keys, Names names) {
  const auto color = keys.vector(names);
  if (!color) return std::nullopt;
  if (color->minCoeff() < 0.0 || color->maxCoeff() > 1.0)
    keys.document().warning(keys.node(), fmt::format("{} isn't between 0 and 1", *names.begin()));
  return color->cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace

void ElementReader::read_shape(Mapping& keys, const Place& place) {
  Document& document = *place.document;
  const Eigen::Affine3d transform = place.transform * keys.transform();
  Shape shape;
  shape.name = keys.text({"name"}).value_or("");
  if (const YamlNode* appearance = keys.find({"appearance"})) shape.color = read_appearance(*appearance, document);
  for (const char* unread : {"elements", "material"})
    if (const YamlNode* value = keys.find({unread}))
      document.warning(*value, fmt::format("{} of a Shape isn't read", unread));
  const YamlNode* node = keys.find({"geometry"});
  if (node == nullptr) return;
  Mapping geometry(*node, "a geometry", document);
  if (!geometry.is_map()) return;
  const std::string type = geometry.text({"type"}).value_or("");
  if (type == "Resource") {
    const std::string uri = geometry.text({"uri"}).value_or("");
    const std::string fragment = geometry.text({"fragment", "node"}).value_or("");
    const Result<NamedFile> file = files_.find(uri, document);
    if (file)
      read_mesh(*node, uri, *file, fragment, transform, std::move(shape), place);
    else
      document.error(*node, fmt::format("the mesh {}: {}", in_quotes(uri), file.errors().front().message),
                     file.errors().front().hint);
    geometry.find({"metadata"});
    return geometry.finish();
  }
  std::optional<SolidShape> solid = read_geometry(type, geometry);
  geometry.finish({"division_number", "divisionNumber", "top", "bottom", "extra_division_number", "extra_division_mode",
                   "beginCap", "begin_cap", "solid", "convex", "ccw", "texCoord", "texCoordIndex"});
  if (!solid) return;
  shape.pose.translation() = transform.translation();
  if (solid->geometry) {
    Eigen::Matrix3d linear = transform.linear() * solid->turn;
    if (auto exact = scaled(*solid->geometry, linear)) {
      shape.geometry = *std::move(exact);
      shape.pose.linear() = linear;
      return add_shape(*node, std::move(shape), place);
    }
  }
  add_mesh(*node, std::move(solid->polygons), std::move(shape), transform, place);
}

void ElementReader::add_mesh(const YamlNode& at, PolygonMesh polygons, Shape shape, const Eigen::Affine3d& transform,
                             const Place& place) {
  Eigen::Affine3d scale = Eigen::Affine3d::Identity();
  Eigen::Vector3d factors;
  Eigen::Matrix3d rotation;
  shape.pose.translation() = transform.translation();
  if (split(transform.linear(), rotation, factors)) {
    shape.pose.linear() = rotation;
    scale.linear() = factors.asDiagonal();
  } else {
    scale.linear() = transform.linear();
  }
  Result<MeshPart> part = part_of(polygons, scale);
  if (!part) {
    const std::string& reason = part.errors().front().message;
    if (polygons.faces.empty()) return place.document->warning(at, "a geometry has no faces; it is left out");
    return place.document->error(at, fmt::format("a geometry can't be used: {}", reason));
  }
  std::vector<MeshPart> parts;
  parts.push_back(*std::move(part));
  shape.geometry = Mesh{mesh_of(std::move(parts)), nullptr};
  add_shape(at, std::move(shape), place);
}

void ElementReader::add_shape(const YamlNode& at, Shape shape, const Place& place) {
  if (!place.is_collision) contents_.visuals.push_back(shape);
  if (place.is_visual) return;
  shape.color.reset();
  Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
  if (mesh != nullptr && mesh->hulls == nullptr && mesh->data != nullptr && !files_.skips_meshes()) {
    Result<ConvexHulls> hulls = convex_hulls(*mesh->data);
    if (!hulls) {
      const std::string reason = hulls.errors().front().message;
      return place.document->warning(at, fmt::format("a geometry can't be used for contact: {}", reason));
    }
    for (const Diagnostic& remark : hulls->remarks) place.document->note(at, "a geometry: " + remark.message);
    mesh->hulls = std::make_shared<const std::vector<ConvexHull>>(std::move(hulls->hulls));
  }
  contents_.collisions.push_back(std::move(shape));
}

std::optional<Color> ElementReader::read_appearance(const YamlNode& node, Document& document) {
  Mapping appearance(node, "an appearance", document);
  if (!appearance.is_map()) return std::nullopt;
  if (appearance.find({"texture"}) != nullptr) document.passed_over(node, "an appearance", "texture");
  appearance.find({"textureTransform", "texture_transform"});
  const YamlNode* value = appearance.find({"material"});
  appearance.finish();
  if (value == nullptr) return std::nullopt;
  Mapping material(*value, "a material", document);
  if (!material.is_map()) return std::nullopt;
  const Eigen::Vector3d diffuse = read_color(material, {"diffuse", "diffuseColor"}).value_or(Eigen::Vector3d::Ones());
  const double transparency = std::clamp(material.soft_number({"transparency"}, 0.0), 0.0, 1.0);
  for (const char* looks : {"ambient", "ambientIntensity", "specular", "specularColor", "shininess",
                            "specular_exponent", "emissive", "emissiveColor"})
    material.find({looks});
  material.finish();
  Color color;
  color << diffuse.cast<float>(), static_cast<float>(1.0 - transparency);
  return color;
}

}  // namespace rehearse::body
