#include <rehearse/io.h>

#include <bit>
#include <cmath>

namespace rehearse {

void round_to_resolution(DepthImage& depth) {
  constexpr std::uint32_t dropped = 24 - 13;  // of float's 24 significant bits
  for (float& meters : depth.meters) {
    const auto bits = std::bit_cast<std::uint32_t>(meters);
    const std::uint32_t half = 1u << (dropped - 1);
    if (std::isfinite(meters)) meters = std::bit_cast<float>((bits + half) & ~((1u << dropped) - 1));
  }
}

}  // namespace rehearse
