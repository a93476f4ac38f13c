// Functions for small scenes in the renderer's tests.
#pragma once

#include <rehearse/renderer.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

namespace rehearse {

inline const Color red{1.0f, 0.0f, 0.0f, 1.0f};
inline const Color green{0.0f, 1.0f, 0.0f, 1.0f};
inline const Color blue{0.0f, 0.0f, 1.0f, 1.0f};
inline const Color grey{0.5f, 0.5f, 0.5f, 1.0f};

inline const Eigen::Isometry3d at_origin = Eigen::Isometry3d::Identity();  // looks along -z, +y is up
inline const Eigen::Isometry3d scene_view = look_at({2.0, -1.0, 1.2}, {0.0, 0.0, 0.3});

inline std::unique_ptr<Renderer> make_renderer(const Look& look = {}) {
  Result<std::unique_ptr<Renderer>> renderer = Renderer::create(look);
  if (renderer) return std::move(*renderer);
  ADD_FAILURE() << to_string(renderer.errors());
  return nullptr;
}

inline Shape shape_at(const Geometry& geometry, const Eigen::Vector3d& position) {
  Shape shape;
  shape.geometry = geometry;
  shape.pose.translation() = position;
  return shape;
}

inline Camera camera_of(int width, int height, double field_of_view = 1.0) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.field_of_view = field_of_view;
  camera.depth = true;
  return camera;
}

/// Red, green, blue of a pixel, (0, 0) at the top left.
inline std::array<int, 3> pixel(const Image& image, int x, int y) {
  const std::size_t at =
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)) * 3;
  return {image.pixels[at], image.pixels[at + 1], image.pixels[at + 2]};
}

inline float meters(const DepthImage& image, int x, int y) {
  return image
      .meters[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
}

enum class Hue { reddish, greenish, bluish, none };

/// The dominant colour of a pixel.
inline Hue hue(const std::array<int, 3>& rgb) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (rgb[i] > 2 * rgb[(i + 1) % 3] + 20 && rgb[i] > 2 * rgb[(i + 2) % 3] + 20) return static_cast<Hue>(i);
  }
  return Hue::none;
}

}  // namespace rehearse
