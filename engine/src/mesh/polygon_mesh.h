// Meshes that a text describes by polygons, or by the measures of a solid: IndexedFaceSet, Extrusion, Cone and others
// of VRML97 (ISO/IEC 14772-1), which Choreonoid's models use, too. All solids are centred, with their axis along y.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace rehearse {

/// Polygons, counter-clockwise seen from outside.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;             // [m]
  std::vector<std::vector<int>> faces;               // indices of vertices, at least three each
  std::vector<Eigen::Vector2d> texture_coordinates;  // empty: none
  std::vector<std::vector<int>> texture_faces;  // indices of texture coordinates, parallel to faces; empty: as faces
  double crease_angle = 0.0;                    // faces that meet at a smaller angle are shaded smoothly [rad]
};

PolygonMesh box_polygons(const Eigen::Vector3d& size);
PolygonMesh sphere_polygons(double radius, int divisions = 20);
PolygonMesh cylinder_polygons(double radius, double height, int divisions = 20);
PolygonMesh cone_polygons(double radius, double height, int divisions = 20);
PolygonMesh capsule_polygons(double radius, double height_without_caps, int divisions = 20);

/// A section that is moved along a spine.
struct Extrusion {
  std::vector<Eigen::Vector2d> section = {{1, 1}, {1, -1}, {-1, -1}, {-1, 1}, {1, 1}};  // x and z
  std::vector<Eigen::Vector3d> spine = {{0, 0, 0}, {0, 1, 0}};
  std::vector<Eigen::Matrix3d> orientations;  // one for all or one per point of the spine; empty: none
  std::vector<Eigen::Vector2d> scales;        // of the section's x and z, likewise
  bool begin_cap = true;
  bool end_cap = true;
  double crease_angle = 0.0;
};
/// The same polygons as in Choreonoid. An error without two points of the spine and of the section.
Result<PolygonMesh> extrusion_polygons(const Extrusion& extrusion);

/// A grid of heights along y over x and z, row by row along z.
struct ElevationGrid {
  int x_count = 0, z_count = 0;
  double x_spacing = 1.0, z_spacing = 1.0;  // [m]
  std::vector<double> heights;              // [m]
  double crease_angle = 0.0;
};
Result<PolygonMesh> elevation_polygons(const ElevationGrid& grid);

/// The triangles of the polygons, their vertices transformed by `place`, which may scale, shear and mirror. Concave
/// polygons are cut at their ears. Polygons without area are left out. An error if an index is out of range, a number
/// isn't finite, or no triangle is left.
Result<MeshPart> part_of(const PolygonMesh& polygons, const Eigen::Affine3d& place);

/// A mesh of one or more parts that no file contains: with its bounds, and a digest of its numbers.
std::shared_ptr<const MeshData> mesh_of(std::vector<MeshPart> parts);

}  // namespace rehearse
