#include "renderer_meshes.h"

#include <cmath>
#include <numbers>

namespace rehearse {
namespace {

// The distance of a chord of one of n segments from the centre is cos(pi / n) times that of its ends: with 80 segments
// the loss is 0.08 %. A sphere has this loss along both circles. Each mesh is enlarged by half of its loss, so that it
// is as much too large at its edges as it is too small between them.
constexpr int segments = 80;         // around the axis
constexpr int rings = segments / 2;  // from pole to pole
const double sagitta = 1.0 - std::cos(std::numbers::pi / segments);

std::array<float, 3> to_floats(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// The i-th of `segments` points on the unit circle; the same bits after a full turn.
std::array<double, 2> on_circle(int i) {
  const double around = 2.0 * std::numbers::pi * (i % segments) / segments;
  return {std::cos(around), std::sin(around)};
}

void add_triangle(UnitMesh& mesh, std::size_t a, std::size_t b, std::size_t c) {
  for (const std::size_t index : {a, b, c}) mesh.indices.push_back(static_cast<std::uint32_t>(index));
}

/// One circle of segments + 1 vertices (the first and the last at one place) on the sphere of radius 1 * `blow_up`;
/// ring 0 is the upper pole, the last one the lower.
void add_ring(UnitMesh& mesh, int ring, double blow_up, float shift) {
  const double polar_angle = std::numbers::pi * ring / rings;
  const double r = ring % rings == 0 ? 0.0 : std::sin(polar_angle);
  const double z = std::cos(polar_angle);
  for (int i = 0; i <= segments; ++i) {
    const double x = r * on_circle(i)[0];
    const double y = r * on_circle(i)[1];
    mesh.vertices.push_back({to_floats(x * blow_up, y * blow_up, z * blow_up), to_floats(x, y, z), shift});
  }
}

enum class Between { poles, upper_pole_and_ring, ring_and_lower_pole };

/// Connects the last two rings with triangles; the first of them is the upper one. At a pole a quad is a triangle.
void join_last_rings(UnitMesh& mesh, Between where = Between::poles) {
  const std::size_t lower = mesh.vertices.size() - (segments + 1);
  const std::size_t upper = lower - (segments + 1);
  for (std::size_t i = 0; i < segments; ++i) {
    if (where != Between::ring_and_lower_pole) add_triangle(mesh, lower + i, lower + i + 1, upper + i + 1);
    if (where != Between::upper_pole_and_ring) add_triangle(mesh, lower + i, upper + i + 1, upper + i);
  }
}

/// A sphere; with a shift its equator exists twice, so that its halves can be moved apart.
UnitMesh sphere_of_halves(float shift) {
  UnitMesh mesh;
  const double blow_up = 1.0 + sagitta;
  const int equator = rings / 2;
  add_ring(mesh, 0, blow_up, shift);
  for (int ring = 1; ring <= rings; ++ring) {
    add_ring(mesh, ring, blow_up, ring <= equator ? shift : -shift);
    join_last_rings(mesh, ring == 1       ? Between::upper_pole_and_ring
                          : ring == rings ? Between::ring_and_lower_pole
                                          : Between::poles);
    if (ring == equator && shift != 0.0f) {
      add_ring(mesh, ring, blow_up, -shift);
      join_last_rings(mesh);
    }
  }
  return mesh;
}

void add_disc(UnitMesh& mesh, double radius, double z) {
  const std::size_t first = mesh.vertices.size();
  const bool up = z > 0.0;
  for (int i = 0; i < segments; ++i) {
    const auto [x, y] = on_circle(up ? i : segments - i);
    mesh.vertices.push_back({to_floats(radius * x, radius * y, z), to_floats(0.0, 0.0, up ? 1.0 : -1.0), 0.0f});
  }
  for (std::size_t i = 1; i + 1 < segments; ++i) add_triangle(mesh, first, first + i, first + i + 1);
}

}  // namespace

UnitMesh box_mesh() {
  UnitMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const std::size_t first = mesh.vertices.size();
      const auto u = static_cast<std::size_t>((axis + 1) % 3);
      const auto v = static_cast<std::size_t>((axis + 2) % 3);
      // u, v and the outward normal are right-handed when the u direction turns with the side
      for (const auto& [along_u, along_v] : {std::array{-side, -1.0f}, {side, -1.0f}, {side, 1.0f}, {-side, 1.0f}}) {
        Vertex vertex{{}, {}, 0.0f};
        vertex.normal[static_cast<std::size_t>(axis)] = side;
        vertex.position[static_cast<std::size_t>(axis)] = 0.5f * side;
        vertex.position[u] = 0.5f * along_u;
        vertex.position[v] = 0.5f * along_v;
        mesh.vertices.push_back(vertex);
      }
      add_triangle(mesh, first, first + 1, first + 2);
      add_triangle(mesh, first, first + 2, first + 3);
    }
  }
  return mesh;
}

UnitMesh sphere_mesh() { return sphere_of_halves(0.0f); }

UnitMesh capsule_mesh() { return sphere_of_halves(1.0f); }

UnitMesh cylinder_mesh() {
  UnitMesh mesh;
  const double radius = 1.0 + 0.5 * sagitta;
  for (const double z : {0.5, -0.5}) {
    for (int i = 0; i <= segments; ++i) {
      const auto [x, y] = on_circle(i);
      mesh.vertices.push_back({to_floats(radius * x, radius * y, z), to_floats(x, y, 0.0), 0.0f});
    }
  }
  join_last_rings(mesh);
  add_disc(mesh, radius, 0.5);
  add_disc(mesh, radius, -0.5);
  return mesh;
}

}  // namespace rehearse
