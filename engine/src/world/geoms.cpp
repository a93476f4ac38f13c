#include "geoms.h"

#include <algorithm>
#include <cstddef>

namespace rehearse {
namespace {

/// A hull in ODE's form. ODE computes only its bounds; Rehearse computes contacts and beams.
struct OdeConvex {
  std::vector<dReal> planes, points;
  std::vector<unsigned int> polygons;  // for each polygon the number of vertices, then their indices
};

/// The face's outline from the corner where it turns the most: ODE takes the first three points for its direction, and
/// reports an error if they are nearly in line.
std::vector<int> with_plain_corner_first(std::vector<int> face, const std::vector<Eigen::Vector3d>& vertices) {
  const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
    return vertices[static_cast<std::size_t>(face[i % face.size()])];
  };
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const double area = (at(i + 1) - at(i)).cross(at(i + 2) - at(i)).squaredNorm();
    if (area <= most) continue;
    most = area;
    best = i;
  }
  std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(best), face.end());
  return face;
}

MadeGeom make_hull(ConvexHull hull) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& vertex : hull.vertices) middle += vertex / static_cast<double>(hull.vertices.size());
  for (Eigen::Vector3d& vertex : hull.vertices) vertex -= middle;
  const auto polytope = std::make_shared<const Polytope>(hull);
  const auto arrays = std::make_shared<OdeConvex>();
  for (const Plane& plane : polytope->planes())
    arrays->planes.insert(arrays->planes.end(), {plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.offset});
  for (const Eigen::Vector3d& vertex : hull.vertices)
    arrays->points.insert(arrays->points.end(), vertex.data(), vertex.data() + 3);
  for (const std::vector<int>& face : hull.faces) {
    arrays->polygons.push_back(static_cast<unsigned int>(face.size()));
    const std::vector<int> turned = with_plain_corner_first(face, hull.vertices);
    arrays->polygons.insert(arrays->polygons.end(), turned.begin(), turned.end());
  }
  const dGeomID geom =
      dCreateConvex(nullptr, arrays->planes.data(), static_cast<unsigned int>(hull.faces.size()), arrays->points.data(),
                    static_cast<unsigned int>(hull.vertices.size()), arrays->polygons.data());
  return {geom, polytope, arrays, Eigen::Isometry3d(Eigen::Translation3d(middle))};
}

/// The triangles of a mesh in ODE's form, and ODE's tree of them.
struct OdeTrimesh {
  std::vector<dReal> vertices;
  std::vector<dTriIndex> indices;
  dTriMeshDataID tree = dGeomTriMeshDataCreate();

  OdeTrimesh() = default;
  OdeTrimesh(const OdeTrimesh&) = delete;
  OdeTrimesh& operator=(const OdeTrimesh&) = delete;
  ~OdeTrimesh() { dGeomTriMeshDataDestroy(tree); }
};

MadeGeom make_trimesh(const MeshData& mesh) {
  const auto arrays = std::make_shared<OdeTrimesh>();
  for (const MeshPart& part : mesh.parts) {
    const auto first = static_cast<dTriIndex>(arrays->vertices.size() / 3);
    for (const Eigen::Vector3f& vertex : part.vertices)
      arrays->vertices.insert(arrays->vertices.end(), vertex.data(), vertex.data() + 3);
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t vertex : triangle) arrays->indices.push_back(first + vertex);
  }
  dGeomTriMeshDataBuildDouble(arrays->tree, arrays->vertices.data(), 3 * sizeof(dReal),
                              static_cast<int>(arrays->vertices.size() / 3), arrays->indices.data(),
                              static_cast<int>(arrays->indices.size()), 3 * sizeof(dTriIndex));
  // contacts of hulls with it need the angles between its triangles: ODE aborts without them
  const int done = dGeomTriMeshDataPreprocess2(arrays->tree, 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
  REHEARSE_ASSERT(done != 0, "ODE prepares the triangles");
  return {dCreateTriMesh(nullptr, arrays->tree, nullptr, nullptr, nullptr), nullptr, arrays};
}

/// The heights in ODE's form: a field over x and z with y upwards, whose z runs against the heightmap's y.
MadeGeom make_heightfield(const std::shared_ptr<const Heightmap>& map) {
  constexpr double thickness = 1.0;  // of the ground under its lowest point [m]: deeper shapes don't touch it
  const std::shared_ptr<dxHeightfieldData> data(dGeomHeightfieldDataCreate(), dGeomHeightfieldDataDestroy);
  dGeomHeightfieldDataBuildDouble(data.get(), map->heights.data(), 0, map->size.x(), map->size.y(), map->columns,
                                  map->rows, 1.0, 0.0, thickness, 0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return {dCreateHeightfield(nullptr, data.get(), 1), nullptr, data, pose, map};
}

}  // namespace

std::vector<MadeGeom> make_geoms(const Geometry& geometry) {
  struct Maker {
    std::vector<MadeGeom> operator()(const Box& box) const {
      return {{dCreateBox(nullptr, box.size.x(), box.size.y(), box.size.z()), std::make_shared<const Polytope>(box),
               nullptr}};
    }
    std::vector<MadeGeom> operator()(const Sphere& sphere) const {
      return {{dCreateSphere(nullptr, sphere.radius), nullptr, nullptr}};
    }
    std::vector<MadeGeom> operator()(const Cylinder& c) const {
      return {{dCreateCylinder(nullptr, c.radius, c.length), nullptr, nullptr}};
    }
    std::vector<MadeGeom> operator()(const Capsule& c) const {
      return {{dCreateCapsule(nullptr, c.radius, c.length), nullptr, nullptr}};
    }
    std::vector<MadeGeom> operator()(const Mesh& mesh) const {
      if (mesh.heightmap) return {make_heightfield(mesh.heightmap)};
      if (!mesh.hulls) return {make_trimesh(*mesh.data)};
      std::vector<MadeGeom> geoms;
      for (const ConvexHull& hull : *mesh.hulls) geoms.push_back(make_hull(hull));
      return geoms;
    }
  };
  return std::visit(Maker{}, geometry);
}

}  // namespace rehearse
