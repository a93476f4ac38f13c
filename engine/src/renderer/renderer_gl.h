// OpenGL as the renderer needs it: a context, a target to draw into, and the pictures in it.
//
// Knows nothing of shapes and cameras. OpenGL lives in a thread's current context, so whoever calls anything here calls
// Context::make_current() first.
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

/// A mistake in a call is ours; what remains is memory.
void check_errors();

}  // namespace rehearse::gl
