// Compiled for AVX2. Nothing but xxhash.h is included: an inline function that other sources have too would run on
// processors without AVX2.
#include "digest.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static_assert(XXH_VECTOR == XXH_AVX2);

namespace rehearse {

std::uint64_t digest_by_avx2(const void* data, std::size_t size, std::uint64_t seed) {
  return XXH3_64bits_withSeed(data, size, seed);
}

}  // namespace rehearse
