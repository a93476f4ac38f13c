// digest_of: the hash function of all hashes of a run, XXH3 of 64 bits. Equal bytes have equal digests on every
// machine.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rehearse {

/// By AVX2 where the processor has it, which halves the instructions; the digest is the same.
std::uint64_t digest_of(const void* data, std::size_t size, std::uint64_t seed = 0);

/// Only for processors with AVX2; not in builds for others than x86-64.
std::uint64_t digest_by_avx2(const void* data, std::size_t size, std::uint64_t seed);

/// For all processors; on arm64 by NEON.
std::uint64_t digest_by_sse2(const void* data, std::size_t size, std::uint64_t seed);

}  // namespace rehearse
