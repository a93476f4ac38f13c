#include "digest.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace rehearse {

std::uint64_t digest_by_sse2(const void* data, std::size_t size, std::uint64_t seed) {
  return XXH3_64bits_withSeed(data, size, seed);
}

std::uint64_t digest_of(const void* data, std::size_t size, std::uint64_t seed) {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") ? digest_by_avx2(data, size, seed) : digest_by_sse2(data, size, seed);
#else
  return digest_by_sse2(data, size, seed);
#endif
}

}  // namespace rehearse
