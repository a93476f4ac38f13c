// What a shape becomes in a picture: one item of a single surface, or, of a mesh, one for each of its parts. Internal.
#pragma once

#include "renderer_painter.h"

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace rehearse {

/// A mesh of the Painter, and what it is drawn with. Its items differ in colour, scale and place only.
struct Batch {
  std::size_t mesh;
  gl::Skin skin;
};

struct Item {
  std::size_t batch;
  std::array<float, 4> scale;  // as gl::Instance has it
  std::array<float, 4> color;
  bool shines_through;           // its texture does
  Eigen::Vector3d centre;        // of the sphere that holds all of it, in the shape's frame [m]
  double radius;                 // of that sphere, a little more than needed [m]
  Eigen::Isometry3d shape_pose;  // in the link's frame
  Eigen::Isometry3d world_pose = shape_pose;
  Eigen::Vector3d world_centre = world_pose * centre;

  bool solid() const { return color[3] >= 1.0f && !shines_through; }
  bool translucent() const { return color[3] > 0.0f && !solid(); }
  /// Grounds, walls and rooms only receive shadows: a map that holds them has no resolution left for robots.
  bool casts_shadow() const { return solid() && radius < 3.0; }
  void place(const Eigen::Isometry3d& link_pose) {
    world_pose = link_pose * shape_pose;
    world_centre = world_pose * centre;
  }
};

/// Makes items of shapes, and batches for them. Meshes and textures that are shared by shapes are there once.
class ItemMaker {
 public:
  explicit ItemMaker(gl::Painter& painter);

  /// The shape's items; `color` is used where neither the shape nor a part of its mesh has one of its own.
  std::vector<Item> items_of(const Shape& shape, const Color& color);
  /// Those of the solid shapes come first, numbered as Geometry's alternatives.
  const std::vector<Batch>& batches() const { return batches_; }

 private:
  struct KnownTexture {
    std::shared_ptr<const Texture> data;
    unsigned name;
    bool shines_through;
  };
  struct KnownPart {
    std::size_t batch;
    bool shines_through;
    Eigen::Vector3d centre;
    double radius;
  };
  struct KnownMesh {
    std::shared_ptr<const MeshData> data;
    std::vector<KnownPart> parts;
  };

  std::size_t add_batch(std::size_t mesh, const gl::Skin& skin);
  const KnownTexture& know(const std::shared_ptr<const Texture>& texture);
  const KnownMesh& know(const std::shared_ptr<const MeshData>& mesh);
  KnownPart take_in(const MeshPart& part, bool closed);

  gl::Painter& painter_;
  std::vector<Batch> batches_;
  std::vector<KnownTexture> textures_;  // in the order in which they came, as the next; kept alive, so none comes twice
  std::vector<KnownMesh> meshes_;
};

}  // namespace rehearse
