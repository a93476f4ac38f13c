#include "exposure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace rehearse {

std::vector<ExposedTick> exposed_ticks(const Exposure& exposure, int height, double time_step) {
  if (exposure.is_instant()) return {};
  constexpr double rounding = 1e-9;  // [ticks]
  const int frames = exposure.time > 0.0 ? exposure.frames : 1;
  std::map<std::int64_t, std::vector<int>> weights;
  for (int row = 0; row < height; ++row) {
    const double begin = exposure.readout * row / height;
    for (int frame = 0; frame < frames; ++frame) {
      const double time = begin + exposure.time * (frame + 0.5) / frames;
      std::vector<int>& of_rows = weights[static_cast<std::int64_t>(std::floor(time / time_step + rounding))];
      of_rows.resize(static_cast<std::size_t>(height));
      ++of_rows[static_cast<std::size_t>(row)];
    }
  }
  std::vector<ExposedTick> ticks;
  for (auto& [after, of_rows] : weights) ticks.push_back({after, std::move(of_rows)});
  return ticks;
}

LightSum::LightSum(int width, int height)
    : width_(width), height_(height), sums_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {}

void LightSum::add(const Image& picture, const std::vector<int>& weights) {
  const std::size_t stride = sums_.size() / weights.size();
  for (std::size_t row = 0; row < weights.size(); ++row) {
    if (weights[row] == 0) continue;
    const auto weight = static_cast<std::uint32_t>(weights[row]);
    for (std::size_t i = row * stride; i < (row + 1) * stride; ++i)
      sums_[i] += weight * picture.pixels[i] * picture.pixels[i];
  }
  count_ += weights.front();
}

Image LightSum::mean() const {
  Image picture;
  picture.width = width_;
  picture.height = height_;
  picture.pixels.resize(sums_.size());
  std::ranges::transform(sums_, picture.pixels.begin(), [this](std::uint32_t sum) {
    return static_cast<std::uint8_t>(std::lround(std::sqrt(static_cast<double>(sum) / count_)));
  });
  return picture;
}

}  // namespace rehearse
