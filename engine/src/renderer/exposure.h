// Exposure: a picture as the mean light of the ticks in which its rows are exposed. Private to the renderer.
//
// The mean is that of the squares of the colours, as light adds up in the renderer. Nothing is rounded before the end.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>

#include <cstdint>
#include <vector>

namespace rehearse {

/// A tick in which rows of a picture are exposed.
struct ExposedTick {
  std::int64_t after = 0;    // the capture's tick
  std::vector<int> weights;  // by row from the top: how many of its sub-frames belong to the tick
};

/// The ticks of a capture, ascending. Empty: all rows are exposed in the moment of the capture. `time_step` [s].
std::vector<ExposedTick> exposed_ticks(const Exposure& exposure, int height, double time_step);

class LightSum {
 public:
  LightSum(int width, int height);
  /// Adds a picture of that size, each row as often as `weights` says.
  void add(const Image& picture, const std::vector<int>& weights);
  /// The mean. Each row must have been added equally often, at least once.
  Image mean() const;

 private:
  int width_, height_;
  int count_ = 0;                    // of sub-frames of the first row
  std::vector<std::uint32_t> sums_;  // of the squares of the colours
};

}  // namespace rehearse
