// Renderer: pictures of a scene, drawn in software by OSMesa, the same bits every time.
//
// A scene is a list of shapes; each has a pose that may change between pictures. Nothing of a picture influences the
// next one, whatever their sizes. One thread per Renderer; several Renderers may stand beside each other.
//
// Solid shapes hide what is behind them; one with an opacity below 1 lets it shine through, and one of opacity 0 isn't
// there at all. Of solids only outsides are drawn: a camera inside of one looks out of it. An object of a mesh is a
// solid if it is closed and faces outwards; of others, open or wound the wrong way round, both sides are drawn, and
// whichever is seen is lit. The parts of a mesh have their own colours and textures; those that let light through are
// mixed like shapes. Squares of a checkered shape have its opacity; where they are smaller than pixels, their mean is
// seen. Light comes from the sky, from a sun that stands still in the world, from the camera, and from the lights that
// were added; these cast no shadows. A picture without lights, or with all of them off, has the same pixels as if
// there were no such thing.
//
// Boxes are exact. Round shapes are made of flat faces whose distance from the axis or centre is within 0.08 % of the
// radius of the true one, half of it inside and half outside.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/scene_settings.h>

#include <Eigen/Geometry>
#include <memory>
#include <string>

namespace rehearse {

/// What one camera sees at one moment.
struct Frame {
  Image color;
  DepthImage depth;  // empty unless asked for
};

enum class Quality {
  plain,  // what sensors see: no shadows, one sample a pixel
  fine,   // for people to look at: the sun casts shadows of solid shapes up to 6 m across, and edges are smooth
};

class Renderer {
 public:
  /// The largest width and height of a plain picture [pixels]; a fine one has at most a third of it.
  static constexpr int max_size = 8192;
  /// How many lights there may be.
  static constexpr int max_lights = 64;

  /// Fails if OSMesa can't make a context of OpenGL 3.3 with clip control (Mesa has both since 2017).
  static Result<std::unique_ptr<Renderer>> create(const Look& look = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Adds a shape; returns its number. `color` is used where the shape, or the part of its mesh, has none of its own. A
  /// mesh was loaded, and is kept alive, as are its textures, of at most 16384 pixels each way; shapes that share a
  /// mesh share its memory.
  int add(const Shape& shape, const Color& color);
  /// Where the shape's link is in the world (at first: at its origin); the shape's own pose comes on top.
  void set_link_pose(int number, const Eigen::Isometry3d& link_pose);

  /// Adds a light; returns its number among the lights. There are fewer than max_lights.
  int add_light(const Light& light);
  /// Gives a light other figures. Those that no lamp can have are brought to the nearest possible ones.
  void set_light(int number, const Light& light);
  /// Where the light's device frame is in the world (at first: at its origin).
  void set_light_pose(int number, const Eigen::Isometry3d& pose);

  /// Draws what `camera` sees from `pose` (its device frame in the world: it looks along -z, +y is up).
  /// Depth [m] along the optical axis if `camera.depth`, at the centre of each pixel, accurate to 1 mm + 0.1 % up to
  /// 200 m; +inf where nothing is between near_clip and far_clip.
  /// The camera must be possible: a size as above, 0 < field_of_view < pi, 0 < near_clip < far_clip.
  Frame draw(const Camera& camera, const Eigen::Isometry3d& pose, Quality quality = Quality::plain);

  /// The drawing of a plain picture alone: waits until it is complete and leaves it where it is. For measuring what
  /// draw() adds.
  void draw_only(const Camera& camera, const Eigen::Isometry3d& pose);

  /// "OSMesa, Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 128 bits)": what a golden's pixels depend on.
  std::string description() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A pose that looks from `eye` to `target`, two different points, with world +z up (+y if the line of sight is
/// vertical).
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

}  // namespace rehearse
