#include "renderer_items.h"

#include "closed_surface.h"

#include <rehearse/diagnostic.h>

#include <algorithm>
#include <cmath>

namespace rehearse {
namespace {

constexpr double a_little_more = 1.002;  // parts of round shapes are outside their nominal radius

/// The scale of the unit mesh along x, y, z, and the distance of a capsule's caps from its centre.
std::array<float, 4> mesh_scale(const Geometry& geometry) {
  struct Scale {
    Eigen::Vector4d operator()(const Box& box) const { return {box.size.x(), box.size.y(), box.size.z(), 0.0}; }
    Eigen::Vector4d operator()(const Sphere& s) const { return {s.radius, s.radius, s.radius, 0.0}; }
    Eigen::Vector4d operator()(const Cylinder& c) const { return {c.radius, c.radius, c.length, 0.0}; }
    Eigen::Vector4d operator()(const Capsule& c) const { return {c.radius, c.radius, c.radius, 0.5 * c.length}; }
    Eigen::Vector4d operator()(const Mesh&) const { return {1.0, 1.0, 1.0, 0.0}; }
  };
  const Eigen::Vector4f scale = std::visit(Scale{}, geometry).cast<float>();
  return {scale[0], scale[1], scale[2], scale[3]};
}

/// Radius of the sphere around a solid shape's centre that contains the whole shape [m].
double bounding_radius(const Geometry& geometry) {
  struct Radius {
    double operator()(const Box& box) const { return 0.5 * box.size.norm(); }
    double operator()(const Sphere& sphere) const { return sphere.radius; }
    double operator()(const Cylinder& c) const { return std::hypot(c.radius, 0.5 * c.length); }
    double operator()(const Capsule& c) const { return c.radius + 0.5 * c.length; }
    double operator()(const Mesh&) const { return 0.0; }  // each part of a mesh has its own radius
  };
  return a_little_more * std::visit(Radius{}, geometry);
}

std::array<float, 4> to_floats(const Color& color) { return {color[0], color[1], color[2], color[3]}; }

bool shines_through(const Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
    if (texture.rgba[i] != 255) return true;
  return false;
}

}  // namespace

ItemMaker::ItemMaker(gl::Painter& painter) : painter_(painter) {
  for (std::size_t solid = 0; solid + 1 < std::variant_size_v<Geometry>; ++solid) add_batch(solid, {});
}

std::size_t ItemMaker::add_batch(std::size_t mesh, const gl::Skin& skin) {
  batches_.push_back({mesh, skin});
  return batches_.size() - 1;
}

std::vector<Item> ItemMaker::items_of(const Shape& shape, const Color& color) {
  const Color base = shape.color.value_or(color);
  std::vector<Item> items;
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    REHEARSE_ASSERT(mesh->data, "a model that is drawn was loaded with its meshes");
    const std::vector<KnownPart>& parts = know(mesh->data).parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const MeshPart& part = mesh->data->parts[i];
      const Color own = color_of(part, shape, color);
      items.push_back({parts[i].batch, mesh_scale(shape.geometry), to_floats(own), parts[i].shines_through,
                       parts[i].centre, parts[i].radius, shape.pose});
      if (part.texture || !texture_of(part, shape)) continue;
      const KnownTexture& texture = know(shape.texture);
      const Batch plain = batches_[parts[i].batch];
      items.back().batch = add_batch(plain.mesh, textured(plain.skin, texture));
      items.back().shines_through = texture.shines_through;
    }
    return items;
  }
  std::size_t batch = shape.geometry.index();
  if (shape.checker) {
    gl::Skin skin{gl::Skin::Kind::checkered};
    skin.second_color = {shape.checker->color[0], shape.checker->color[1], shape.checker->color[2]};
    skin.squares_per_meter = static_cast<float>(1.0 / shape.checker->size);
    batch = add_batch(batch, skin);
  }
  items.push_back({batch, mesh_scale(shape.geometry), to_floats(base), false, Eigen::Vector3d::Zero(),
                   bounding_radius(shape.geometry), shape.pose});
  return items;
}

const ItemMaker::KnownTexture& ItemMaker::know(const std::shared_ptr<const Texture>& texture) {
  const auto known = std::ranges::find_if(textures_, [&](const auto& t) { return t.data == texture; });
  if (known != textures_.end()) return *known;
  textures_.push_back({texture, painter_.add(*texture), shines_through(*texture)});
  return textures_.back();
}

const ItemMaker::KnownMesh& ItemMaker::know(const std::shared_ptr<const MeshData>& mesh) {
  const auto known = std::ranges::find_if(meshes_, [&](const auto& m) { return m.data == mesh; });
  if (known != meshes_.end()) return *known;
  KnownMesh taken{mesh, {}};
  const std::vector<bool> closed = closed_parts(*mesh);
  for (std::size_t i = 0; i < mesh->parts.size(); ++i) taken.parts.push_back(take_in(mesh->parts[i], closed[i]));
  meshes_.push_back(std::move(taken));
  return meshes_.back();
}

gl::Skin ItemMaker::textured(gl::Skin skin, const KnownTexture& texture) {
  skin.kind = texture.shines_through ? gl::Skin::Kind::cut_out : gl::Skin::Kind::textured;
  skin.texture = texture.name;
  skin.both_sides = skin.both_sides || texture.shines_through;
  return skin;
}

ItemMaker::KnownPart ItemMaker::take_in(const MeshPart& part, bool closed) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : part.vertices) box.extend(vertex);
  KnownPart known{0, false, Eigen::Vector3d::Zero(), 0.0};
  if (!box.isEmpty()) known.centre = box.center().cast<double>();
  for (const Eigen::Vector3f& vertex : part.vertices)
    known.radius = std::max(known.radius, a_little_more * (vertex.cast<double>() - known.centre).norm());
  gl::Skin skin{gl::Skin::Kind::mesh, !closed};
  if (part.texture && !part.texture_coordinates.empty()) {
    const KnownTexture& texture = know(part.texture);
    skin = textured(skin, texture);
    known.shines_through = texture.shines_through;
  }
  known.batch = add_batch(painter_.add(part), skin);
  return known;
}

}  // namespace rehearse
