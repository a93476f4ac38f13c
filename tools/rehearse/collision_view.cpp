#include "collision_view.h"

#include <array>
#include <memory>
#include <utility>

namespace rehearse::tool {
namespace {

/// Colours one after the other.
class Palette {
 public:
  Color next() {
    static const std::array<Color, 8> colors{Color(0.90f, 0.45f, 0.25f, 1.0f), Color(0.30f, 0.60f, 0.85f, 1.0f),
                                             Color(0.55f, 0.75f, 0.30f, 1.0f), Color(0.80f, 0.50f, 0.80f, 1.0f),
                                             Color(0.95f, 0.80f, 0.30f, 1.0f), Color(0.30f, 0.75f, 0.70f, 1.0f),
                                             Color(0.75f, 0.60f, 0.45f, 1.0f), Color(0.60f, 0.60f, 0.90f, 1.0f)};
    return colors[used_++ % colors.size()];
  }

 private:
  std::size_t used_ = 0;
};

/// A hull with flat faces.
MeshPart part_of(const ConvexHull& hull, int object, const Color& color) {
  MeshPart part;
  part.object = object;
  part.color = color;
  for (const std::vector<int>& face : hull.faces) {
    const auto first = static_cast<std::uint32_t>(part.vertices.size());
    const auto corner = [&](std::size_t i) { return hull.vertices[static_cast<std::size_t>(face[i])]; };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
      normal += (corner(i) - corner(0)).cross(corner(i + 1) - corner(0));
    for (std::size_t i = 0; i < face.size(); ++i) {
      part.vertices.push_back(corner(i).cast<float>());
      part.normals.push_back(normal.normalized().cast<float>());
      const auto at = first + static_cast<std::uint32_t>(i);
      if (i >= 2) part.triangles.push_back({first, at - 1, at});
    }
  }
  return part;
}

/// The geometry that contacts use for the mesh.
Mesh visible(const Mesh& mesh, Palette& palette) {
  MeshData data = *mesh.data;
  if (mesh.hulls) {
    data.parts.clear();
    for (const ConvexHull& hull : *mesh.hulls)
      data.parts.push_back(part_of(hull, static_cast<int>(data.parts.size()), palette.next()));
  } else {
    const Color color = palette.next();
    for (MeshPart& part : data.parts) {
      part.color = color;
      part.has_default_color = false;
      part.texture = nullptr;
    }
  }
  Mesh drawn = mesh;
  drawn.data = std::make_shared<const MeshData>(std::move(data));
  return drawn;
}

}  // namespace

Model with_visible_collisions(const Model& model) {
  Palette palette;
  Model shown = model;
  for (Link& link : shown.links) {
    link.visuals = link.collisions;
    for (Shape& shape : link.visuals) {
      if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
        *mesh = visible(*mesh, palette);
      else
        shape.color = palette.next();
    }
  }
  return shown;
}

}  // namespace rehearse::tool
