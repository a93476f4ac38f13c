// Geometries of shapes, and their scaled forms.
#include <fmt/format.h>

#include <cmath>

#include "base/text.h"
#include "body_elements.h"
#include "mesh/convex_hull.h"

namespace rehearse::body {
namespace {

/// Turns z, the axis of the engine's round shapes, to y, the axis of Choreonoid's round shapes.
Eigen::Matrix3d y_from_z() { return (Eigen::Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished(); }

double positive(Mapping& keys, const char* key) {
  const double value = keys.soft_number({key}, 1.0);
  if (value > 0.0 && value < 1e6) return value;
  keys.document().error(keys.node(), fmt::format("the {} of {} is {} m", key, "a geometry", value), "above 0");
  return 1.0;
}

template <class Vector>
std::vector<Vector> read_points(Mapping& keys, Names names) {
  constexpr auto size = static_cast<std::size_t>(Vector::SizeAtCompileTime);
  std::vector<Vector> points;
  const auto numbers = keys.numbers(names);
  if (!numbers) return points;
  if (numbers->size() % size != 0)
    keys.document().warning(keys.node(), fmt::format("{} has {} numbers, which isn't a multiple of {}", *names.begin(),
                                                     numbers->size(), size));
  for (std::size_t i = 0; i + size <= numbers->size(); i += size) {
    points.push_back(Eigen::Map<const Vector>(numbers->data() + i));
    points.back() = points.back().template cast<float>().template cast<double>();  // as Choreonoid stores them
  }
  return points;
}

/// Lists of indices: of three each, or each ended by -1.
std::vector<std::vector<int>> read_faces(Mapping& keys, Names names, bool in_threes) {
  std::vector<std::vector<int>> faces;
  const auto numbers = keys.numbers(names);
  if (!numbers) return faces;
  std::vector<int> face;
  for (const double number : *numbers) {
    const int index = std::abs(number) < 1e9 ? static_cast<int>(number) : std::numeric_limits<int>::max();
    if (index >= 0) face.push_back(index);
    if (index >= 0 && !(in_threes && face.size() == 3)) continue;
    if (!face.empty()) faces.push_back(std::move(face));
    face.clear();
  }
  if (!face.empty()) faces.push_back(std::move(face));
  return faces;
}

PolygonMesh read_face_set(Mapping& keys, bool in_threes) {
  PolygonMesh mesh;
  mesh.vertices = read_points<Eigen::Vector3d>(keys, {"vertices", "coordinate"});
  mesh.faces = read_faces(keys, {"faces", "coordIndex"}, in_threes);
  mesh.crease_angle = keys.soft_angle({"crease_angle", "creaseAngle"}, 0.0);
  for (const char* looks : {"normals", "normal_indices", "normalIndex", "tex_coords", "texCoord", "tex_coord_indices",
                            "texCoordIndex", "solid"})
    keys.find({looks});
  return mesh;
}

std::optional<PolygonMesh> taken(Result<PolygonMesh> polygons, Mapping& keys) {
  if (polygons) return *std::move(polygons);
  keys.document().error(keys.node(), polygons.errors().front().message);
  return std::nullopt;
}

std::optional<PolygonMesh> read_extrusion(Mapping& keys) {
  Extrusion extrusion;
  const auto section = read_points<Eigen::Vector2d>(keys, {"cross_section", "crossSection"});
  const auto spine = read_points<Eigen::Vector3d>(keys, {"spine"});
  if (!section.empty()) extrusion.section = section;
  if (!spine.empty()) extrusion.spine = spine;
  for (const Eigen::Vector4d& turn : read_points<Eigen::Vector4d>(keys, {"orientation"})) {
    const Eigen::Vector3d axis = turn.head<3>();
    extrusion.orientations.push_back(
        axis.norm() < 1e-6 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                           : Eigen::AngleAxisd(keys.radians(turn[3]), axis.normalized()).toRotationMatrix());
  }
  extrusion.scales = read_points<Eigen::Vector2d>(keys, {"scale"});
  extrusion.crease_angle = keys.soft_angle({"crease_angle", "creaseAngle"}, 0.0);
  extrusion.begin_cap = keys.flag({"beginCap"}).value_or(true);
  extrusion.end_cap = keys.flag({"end_cap", "endCap"}).value_or(true);
  return taken(extrusion_polygons(extrusion), keys);
}

std::optional<PolygonMesh> read_elevation(Mapping& keys) {
  ElevationGrid grid;
  const auto count = [](double value) { return static_cast<int>(std::clamp(value, 0.0, 1e5)); };
  grid.x_count = count(keys.soft_number({"x_dimension", "xDimension"}, 0.0));
  grid.z_count = count(keys.soft_number({"z_dimension", "zDimension"}, 0.0));
  grid.x_spacing = keys.soft_number({"x_spacing", "xSpacing"}, 0.0);
  grid.z_spacing = keys.soft_number({"z_spacing", "zSpacing"}, 0.0);
  grid.crease_angle = keys.soft_angle({"crease_angle", "creaseAngle"}, 0.0);
  grid.heights = keys.numbers({"height"}).value_or(std::vector<double>());
  return taken(elevation_polygons(grid), keys);
}

/// The polygons of a solid as it is, and of its scaled forms.
SolidShape solid(Geometry geometry, PolygonMesh polygons, bool is_round) {
  return {std::move(geometry), is_round ? y_from_z() : Eigen::Matrix3d(Eigen::Matrix3d::Identity()),
          std::move(polygons)};
}

}  // namespace

std::optional<SolidShape> read_geometry(const std::string& type, Mapping& keys) {
  if (type == "Box") {
    Eigen::Vector3d size = keys.vector({"size"}).value_or(Eigen::Vector3d::Ones());
    if (size.minCoeff() == 0.0) {
      keys.document().warning(keys.node(), fmt::format("a Box is flat; it gets a thickness of {} m", sheet_thickness));
      size = size.cwiseMax(sheet_thickness);
    }
    if (!(size.minCoeff() > 0.0)) {
      keys.document().error(keys.node(),
                            fmt::format("a Box has a size of {} x {} x {} m", size.x(), size.y(), size.z()),
                            "full lengths above 0");
      return std::nullopt;
    }
    return solid(Box{size}, box_polygons(size), false);
  }
  if (type == "Sphere") {
    const double radius = positive(keys, "radius");
    return solid(Sphere{radius}, sphere_polygons(radius), false);
  }
  if (type == "Cylinder" || type == "Capsule") {
    const double radius = positive(keys, "radius");
    if (type == "Cylinder") {
      const double height = positive(keys, "height");
      return solid(Cylinder{radius, height}, cylinder_polygons(radius, height), true);
    }
    const double height = keys.soft_number({"height"}, 1.0);
    if (height > 0.0) return solid(Capsule{radius, height}, capsule_polygons(radius, height), true);
    return solid(Sphere{radius}, sphere_polygons(radius), false);
  }
  std::optional<PolygonMesh> polygons;
  if (type == "Cone") {
    const double radius = positive(keys, "radius"), height = positive(keys, "height");
    polygons = cone_polygons(radius, height);
  } else if (type == "IndexedFaceSet" || type == "TriangleMesh") {
    polygons = read_face_set(keys, type == "TriangleMesh");
  } else if (type == "Extrusion") {
    polygons = read_extrusion(keys);
  } else if (type == "ElevationGrid") {
    polygons = read_elevation(keys);
  } else {
    keys.document().error(keys.node(), fmt::format("the geometry type {} isn't known", in_quotes(type)),
                          "Box, Sphere, Cylinder, Cone, Capsule, IndexedFaceSet, TriangleMesh, Extrusion, "
                          "ElevationGrid or Resource");
  }
  if (!polygons) return std::nullopt;
  return SolidShape{std::nullopt, Eigen::Matrix3d::Identity(), *std::move(polygons)};
}

bool split(const Eigen::Matrix3d& linear, Eigen::Matrix3d& rotation, Eigen::Vector3d& scale) {
  constexpr double slack = 1e-9;
  for (int i = 0; i < 3; ++i) {
    scale[i] = linear.col(i).norm();
    if (!(scale[i] > 0.0)) return false;
    rotation.col(i) = linear.col(i) / scale[i];
  }
  if (rotation.determinant() < 0.0) {  // a mirror image: becomes one along x
    scale.x() = -scale.x();
    rotation.col(0) = -rotation.col(0);
  }
  return (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < slack;
}

std::optional<Geometry> scaled(const Geometry& geometry, Eigen::Matrix3d& linear) {
  constexpr double slack = 1e-9;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d scale;
  if (!split(linear, rotation, scale)) return std::nullopt;
  scale = scale.cwiseAbs();  // all these solids are their own mirror images
  const auto alike = [](double a, double b) { return std::abs(a - b) <= slack * std::max(a, b); };
  const bool is_even = alike(scale.x(), scale.y()) && alike(scale.y(), scale.z());
  linear = rotation;
  if (is_even && alike(scale.x(), 1.0)) return geometry;
  if (const auto* box = std::get_if<Box>(&geometry)) return Box{box->size.cwiseProduct(scale)};
  if (const auto* sphere = std::get_if<Sphere>(&geometry); sphere != nullptr && is_even)
    return Sphere{sphere->radius * scale.x()};
  if (!alike(scale.x(), scale.y())) return std::nullopt;  // along z is the axis
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return Cylinder{cylinder->radius * scale.x(), cylinder->length * scale.z()};
  if (const auto* capsule = std::get_if<Capsule>(&geometry))
    return Capsule{capsule->radius * scale.x(), capsule->length * scale.z()};
  return std::nullopt;
}

}  // namespace rehearse::body
