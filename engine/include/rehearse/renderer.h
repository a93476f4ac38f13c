// Renderer: pictures of a scene, drawn in software by OSMesa, the same bits every time.
//
// A scene is a list of shapes; each has a pose that may change between pictures. One thread. Nothing of a picture
// influences the next one.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/image.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <memory>
#include <string>

namespace rehearse {

/// What one camera sees at one moment.
struct Frame {
  Image color;
  DepthImage depth;  // empty unless asked for
};

/// What is seen where nothing is, and how the scene is lit.
struct Look {
  Color sky{0.55f, 0.68f, 0.82f, 1.0f};
};

class Renderer {
 public:
  /// Fails if OSMesa can't make a context.
  static Result<std::unique_ptr<Renderer>> create(const Look& look = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Adds a shape; returns its number. `color` is used where the shape has none of its own.
  int add(const Shape& shape, const Color& color);
  /// Where the shape's link is in the world; the shape's own pose comes on top.
  void set_link_pose(int number, const Eigen::Isometry3d& link_pose);

  /// Draws what `camera` sees from `pose` (its device frame in the world: it looks along -z, +y is up).
  /// Depth [m] along the optical axis if `camera.depth`; +inf where nothing is nearer than far_clip.
  Frame draw(const Camera& camera, const Eigen::Isometry3d& pose);

  /// "OSMesa, Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 128 bits)": what a golden's pixels depend on.
  std::string description() const;

 private:
  Renderer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A pose that looks from `eye` to `target` with world +z up (+y if the line of sight is vertical).
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace rehearse
