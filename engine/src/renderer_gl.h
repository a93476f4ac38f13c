// OpenGL as the renderer needs it: a context, one shader program, a target to draw into, and the pictures in it.
//
// Knows nothing of shapes and cameras. OpenGL lives in a thread's current context, so whoever calls anything here calls
// Context::make_current() first.
#pragma once

#include "renderer_meshes.h"

#include <rehearse/diagnostic.h>
#include <rehearse/image.h>
#include <rehearse/model.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct osmesa_context;

namespace rehearse::gl {

/// An OSMesa context; frees all that was made in it when it goes.
class Context {
 public:
  static Result<std::unique_ptr<Context>> create();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  void make_current();
  std::string description() const { return description_; }

 private:
  Context() = default;
  Result<void> check_abilities();

  osmesa_context* handle_ = nullptr;
  std::array<unsigned char, 4> window_{};  // OSMesa wants a buffer; pictures are drawn into Targets
  std::string description_;
};

/// One shape as the vertex shader reads it, in the camera's frame.
struct Instance {
  std::array<float, 9> rotation;  // columns: the shape's axes
  std::array<float, 3> origin;    // [m]
  std::array<float, 4> scale;     // of the mesh along x, y, z, then its stretch [m]
  std::array<float, 4> color;
};

/// A light that is on, as the fragment shader reads it, in the camera's frame.
struct Lamp {
  std::array<float, 4> place;     // [m]; 1 / range [1/m]
  std::array<float, 4> strength;  // red, green, blue; cosine of the angle from the axis at which it ends
  std::array<float, 4> fading;    // constant, linear, quadratic; 1 / (cosine where it is full - where it ends)
  std::array<float, 4> axis;      // unit vector along which it shines; unused
};

/// Column by column.
using Matrix4 = std::array<float, 16>;

/// What is drawn into, and how.
enum class Pass {
  plain,   // into a Target
  fine,    // into a Target, with the shadows of a ShadowMap that was drawn before
  shadow,  // into a ShadowMap
};

/// What is the same for all shapes of one pass. The frame of a shadow pass is the sun's.
struct View {
  Matrix4 projection;          // from the camera's frame; z from 1 at the near clip down to 0 at the far clip
  std::array<float, 3> up{};   // world +z in the camera's frame
  std::array<float, 3> sun{};  // direction towards the sun in the camera's frame
  Matrix4 shadow_from_view{};  // fine only: to the coordinates of the shadow map, 0 to 1
  float blur = 0.0f;           // fine only: of the edges of shadows, in those coordinates
  std::vector<Lamp> lamps{};   // at most Renderer::max_lights
};

/// The meshes, and the programs that draw them.
class Painter {
 public:
  Painter();  // in the current context
  void begin(Pass pass, const View& view);
  /// Draws a run of instances of one mesh, in order; `mesh` as Geometry's alternatives are numbered.
  void paint(std::size_t mesh, std::span<const Instance> instances, bool translucent);

 private:
  struct Buffers {
    unsigned array = 0;
    int count = 0;
  };
  static Buffers upload(const UnitMesh& mesh, unsigned instances);

  unsigned program_of(Pass pass, bool lamps);

  std::array<std::array<unsigned, 2>, 3> programs_{};  // by Pass, without and with lamps; 0: not needed so far
  unsigned instances_ = 0;
  std::array<Buffers, std::variant_size_v<Geometry>> meshes_;
};

/// Where pictures are drawn: colour, z buffer and, if wanted, a float for the distance of each pixel.
class Target {
 public:
  /// Makes it the place that is drawn into, of the given size, and empties it.
  void begin(int width, int height, bool depth, const Color& background);
  /// The picture; with a factor (a divisor of its size, odd) smaller by that, each pixel a mean.
  Image read_color(int factor);
  /// The distances, if they were wanted; with a factor smaller by that, each that of the middle.
  DepthImage read_depth(int factor) const;

 private:
  void allocate();

  int width_ = 0;
  int height_ = 0;
  bool depth_ = false;
  unsigned framebuffer_ = 0;
  std::array<unsigned, 3> buffers_{};  // colour, z, distance
  std::vector<std::uint8_t> pixels_;   // as OpenGL hands them out, four bytes a pixel
};

/// How far from the sun the nearest surfaces are.
class ShadowMap {
 public:
  static constexpr int size = 2048;  // [texels] each way
  /// Makes it the place that is drawn into, and empties it.
  void begin();

 private:
  unsigned framebuffer_ = 0;
  unsigned texture_ = 0;
};

/// Waits until everything is drawn.
void finish();

}  // namespace rehearse::gl
