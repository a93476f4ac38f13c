// OpenGL for the renderer: a context, and targets for colour, depth and shadows.
//
// This part is independent of shapes and cameras. OpenGL works on a thread's current context, so call
// Context::make_current() before any other function here.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

struct osmesa_context;

namespace rehearse::gl {

/// An OSMesa context. Its destructor frees all OpenGL objects that were created in it.
class Context {
 public:
  static Result<std::unique_ptr<Context>> create();
  /// See Renderer.
  static void forgo_threads();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  void make_current();
  std::string description() const { return description_; }

 private:
  Context() = default;
  Result<void> check_abilities();

  osmesa_context* handle_ = nullptr;
  std::array<unsigned char, 4> window_{};  // OSMesa requires a buffer; pictures are drawn into Targets
  std::string description_;
};

/// The framebuffer of a picture: colour, z buffer and, on request, a float for the distance of each pixel.
class Target {
 public:
  /// Makes this the current framebuffer, with the given size, and clears it.
  void begin(int width, int height, bool depth, const Color& background);
  /// Reads the picture, reduced by `factor` (an odd divisor of its size); each pixel is a mean.
  Image read_color(int factor);
  /// Reads the distances (empty if not requested), reduced by `factor`; each is that of the pixel in the middle.
  DepthImage read_depth(int factor) const;

 private:
  void allocate();

  int width_ = 0;
  int height_ = 0;
  bool depth_ = false;
  unsigned framebuffer_ = 0;
  std::array<unsigned, 3> buffers_{};  // colour, z, distance
  std::vector<std::uint8_t> pixels_;   // as OpenGL returns them, four bytes per pixel
};

/// The framebuffer of a shadow map: for each texel the distance of the nearest surface from the sun.
class ShadowMap {
 public:
  static constexpr int size = 2048;  // [texels] each way
  /// Makes this the current framebuffer and clears it.
  void begin();

 private:
  unsigned framebuffer_ = 0;
  unsigned texture_ = 0;
};

/// Waits until all drawing is complete.
void finish();

/// Aborts if OpenGL reports an error: a wrong call (an error in Rehearse) or too little memory.
void check_errors();

}  // namespace rehearse::gl
