// Renderer: pictures of a scene, drawn in software by OSMesa, the same bits every time.
//
// A scene is a list of shapes; each has a pose that may change between pictures. A picture never influences the next
// one, whatever their sizes. Each Renderer belongs to one thread; a process may have several Renderers.
//
// Opaque shapes hide the shapes behind them. A shape with an opacity below 1 is translucent; a shape with opacity 0 is
// not drawn. Only the outside of a solid is drawn, so a camera inside a solid sees the scene around it. An object of a
// mesh is a solid if it is closed and its faces are wound outwards. Of other objects (open, or wound the wrong way
// round) both sides are drawn, and the visible side is lit. The parts of a mesh have their own colours and textures;
// translucent parts are blended like translucent shapes. The squares of a checkered shape have the shape's opacity;
// where they are smaller than pixels, a pixel shows their mean. Light comes from the sky, from a sun at a constant
// direction in the world, from the camera, and from the lights that were added, which cast no shadows. If no light was
// added, or all are off, a picture has the same pixels as a renderer without lights would draw.
//
// Boxes are exact. Round shapes consist of flat faces. Their distance from the axis or centre differs from the true
// radius by at most 0.08 % of it, half of it inside and half outside.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/world_settings.h>

#include <Eigen/Geometry>
#include <memory>
#include <string>

namespace rehearse {

/// The picture of one camera at one moment.
struct Frame {
  Image color;
  DepthImage depth;  // empty unless asked for
};

struct Quality {
  bool shadows = false;       // the sun casts shadows of solid shapes up to 6 m across
  bool antialiasing = false;  // edges are smooth: a pixel is the mean of nine samples

  static const Quality plain;  // neither: for sensors without these settings
  static const Quality fine;   // both: for people to look at
};
inline constexpr Quality Quality::plain{};
inline constexpr Quality Quality::fine{true, true};

class Renderer {
 public:
  /// The library that draws. The first create() of a process loads it.
  static constexpr const char* library = "libOSMesa.so.8";
  /// The largest width and height of a picture [pixels]; a third of this with antialiasing.
  static constexpr int max_size = 8192;
  /// The largest number of lights.
  static constexpr int max_lights = 64;

  /// The scene has the sky and the lights of `look`; its settings for cameras are those of draw()'s caller.
  /// Fails if OSMesa can't be loaded, or can't make a context of OpenGL 3.3 with clip control (Mesa has both since
  /// 2017), or if there are more lights than max_lights.
  static Result<std::unique_ptr<Renderer>> create(const Look& look = {});
  /// From now on this process draws without further threads, in 1.2 times the time. A process that it forks later can
  /// draw, too; otherwise that would wait for ever for the threads that it lacks. Must be called before the first
  /// create().
  static void forgo_threads();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Adds a shape; returns its number. `color` is used where neither the shape nor the part of its mesh has a colour. A
  /// mesh must be loaded, with textures of at most 16384 pixels each way. The renderer keeps the mesh and its textures
  /// alive; shapes that share a mesh share its memory.
  int add(const Shape& shape, const Color& color);
  /// Sets the pose of the shape's link in the world (initially the identity); the shape's own pose is relative to it.
  void set_link_pose(int number, const Eigen::Isometry3d& link_pose);

  /// Adds a light; returns its number among the lights. Precondition: there are fewer than max_lights, with those of
  /// the look.
  int add_light(const Light& light);
  /// Sets the values of a light. Impossible values are replaced by the nearest possible ones.
  void set_light(int number, const Light& light);
  /// Sets the pose of the light's device frame in the world (initially the identity).
  void set_light_pose(int number, const Eigen::Isometry3d& pose);

  /// Draws the picture of `camera` at `pose` (its device frame in the world: it looks along -z, +y is up).
  /// Depth [m] along the optical axis if `camera.depth`, at the centre of each pixel, accurate to 1 mm + 0.1 % up to
  /// 200 m; +inf where no surface is between near_clip and far_clip.
  /// The camera must be possible: a size as above, 0 < field_of_view < pi, 0 < near_clip < far_clip.
  Frame draw(const Camera& camera, const Eigen::Isometry3d& pose, Quality quality = Quality::plain);

  /// Draws a plain picture and waits until it is complete, but doesn't read the pixels back. For measuring how much
  /// time the rest of draw() takes.
  void draw_only(const Camera& camera, const Eigen::Isometry3d& pose);

  /// The versions on which a golden's pixels depend: "OSMesa, Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 128 bits)".
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
