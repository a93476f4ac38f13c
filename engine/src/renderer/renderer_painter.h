// Draws meshes into pictures: their buffers, their textures and the shader programs. Internal.
//
// This part is independent of shapes and cameras. Make the Context current before any call.
#pragma once

#include "renderer_meshes.h"

#include <rehearse/model.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rehearse::gl {

/// The appearance of a surface, except the colour of its instance.
struct Skin {
  enum class Kind {
    even,       // of one colour
    checkered,  // squares of a second colour between those of the first
    mesh,       // of one colour; the visible side is lit as the outside (also for the kinds below)
    textured,   // a texture, multiplied with the instance's colour
    cut_out,    // as textured; pixels whose product has no opacity are not drawn
  };
  static constexpr std::size_t kinds = 5;

  Kind kind = Kind::even;
  bool both_sides = false;              // draw both sides, else only the outside
  unsigned texture = 0;                 // textured, cut_out: the name that Painter::add returned
  std::array<float, 3> second_color{};  // checkered: red, green, blue
  float squares_per_meter = 1.0f;       // checkered
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
  std::array<float, 4> strength;  // red, green, blue; cosine of the cut-off angle from the axis
  std::array<float, 4> fading;    // constant, linear, quadratic; 1 / (cosine of the beam's edge - of the cut-off)
  std::array<float, 4> axis;      // unit vector along which it shines; unused
};

/// A 4 x 4 matrix, column by column.
using Matrix4 = std::array<float, 16>;

/// The kind of framebuffer and the way of drawing.
enum class Pass {
  plain,   // into a Target
  shaded,  // into a Target, with the shadows of a ShadowMap that was drawn before
  shadow,  // into a ShadowMap
};

/// The parameters that are the same for all shapes of one pass. In a shadow pass the camera's frame is the sun's.
struct View {
  Matrix4 projection;          // from the camera's frame; z from 1 at the near clip down to 0 at the far clip
  std::array<float, 3> up{};   // world +z in the camera's frame
  std::array<float, 3> sun{};  // direction towards the sun in the camera's frame
  Matrix4 shadow_from_view{};  // shaded only: to the coordinates of the shadow map, 0 to 1
  float blur = 0.0f;           // shaded only: of the edges of shadows, in coordinates of the shadow map
  float lift = 0.0f;           // shaded only: how far above a mesh its shadow is looked up [m]
  std::vector<Lamp> lamps{};   // at most Renderer::max_lights
};

/// The meshes, the textures, and the programs that draw them.
class Painter {
 public:
  Painter();  // in the current context
  /// Uploads a mesh; returns its number. Numbers continue after those of boxes and round shapes.
  std::size_t add(const MeshPart& part);
  /// Uploads a texture; returns its name for Skin.
  unsigned add(const Texture& texture);

  void begin(Pass pass, const View& view);
  /// Draws instances of one mesh, in order. The first meshes are numbered as Geometry's alternatives.
  void paint(std::size_t mesh, const Skin& skin, std::span<const Instance> instances, bool translucent);

 private:
  struct Buffers {
    unsigned array = 0;
    int count = 0;  // of indices
  };
  struct Program {
    unsigned name = 0;      // OpenGL's name; 0: not created yet
    bool is_ready = false;  // the parameters of this pass's View are set
  };

  Buffers upload(std::span<const Vertex> vertices, std::span<const std::uint32_t> indices) const;
  Program& program_of(Skin::Kind kind);
  void use(const Skin& skin);
  void draw(const Buffers& mesh, std::size_t instances) const;

  std::array<std::array<std::array<Program, Skin::kinds>, 2>, 3> programs_{};  // by Pass, without and with lamps
  Pass pass_ = Pass::plain;
  View view_;
  unsigned instances_ = 0;
  std::vector<Buffers> meshes_;
};

}  // namespace rehearse::gl
