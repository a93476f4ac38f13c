// The drawable items of a shape: one for a box or round shape, one per part for a mesh. Internal.
#pragma once

#include "renderer_painter.h"

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace rehearse {

/// A mesh of the Painter and its skin. Items of one batch differ only in colour, scale and pose.
struct Batch {
  std::size_t mesh;
  gl::Skin skin;
};

struct Item {
  std::size_t batch;
  std::array<float, 4> scale;  // as in gl::Instance
  std::array<float, 4> color;
  bool shines_through;           // the texture is translucent
  Eigen::Vector3d centre;        // of the bounding sphere, in the shape's frame [m]
  double radius;                 // of the bounding sphere, rounded up a little [m]
  Eigen::Isometry3d shape_pose;  // in the link's frame
  Eigen::Isometry3d world_pose = shape_pose;
  Eigen::Vector3d world_centre = world_pose * centre;

  bool solid() const { return color[3] >= 1.0f && !shines_through; }
  bool translucent() const { return color[3] > 0.0f && !solid(); }
  /// Grounds, walls and rooms only receive shadows: a shadow map that covers them would be too coarse for robots.
  bool casts_shadow() const { return solid() && radius < 3.0; }
  void place(const Eigen::Isometry3d& link_pose) {
    world_pose = link_pose * shape_pose;
    world_centre = world_pose * centre;
  }
};

/// Makes items of shapes, and batches for them. Meshes and textures that several shapes share are stored once.
class ItemMaker {
 public:
  explicit ItemMaker(gl::Painter& painter);

  /// The shape's items; `color` is used where neither the shape nor the part of its mesh has a colour.
  std::vector<Item> items_of(const Shape& shape, const Color& color);
  /// All batches. Those of boxes and round shapes come first, numbered as Geometry's alternatives.
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
  static gl::Skin textured(gl::Skin skin, const KnownTexture& texture);

  gl::Painter& painter_;
  std::vector<Batch> batches_;
  std::vector<KnownTexture> textures_;  // in the order of their first use; kept alive, so that each is stored once
  std::vector<KnownMesh> meshes_;
};

}  // namespace rehearse
