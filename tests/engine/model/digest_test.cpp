#include "base/digest.h"

#include <gtest/gtest.h>

#include <string>

namespace rehearse {
namespace {

TEST(Digest, IsThatOfTheSpecification) {
  EXPECT_EQ(digest_of(nullptr, 0), 0x2D06'8005'38D3'94C2u);  // of no bytes: in the tests of xxHash
  EXPECT_EQ(digest_by_sse2(nullptr, 0, 0), 0x2D06'8005'38D3'94C2u);
}

TEST(Digest, IsTheSameByAllRegisters) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
  std::string bytes;
  for (int i = 0; i < 3000; ++i) {
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{12345}})
      ASSERT_EQ(digest_by_avx2(bytes.data(), bytes.size(), seed), digest_by_sse2(bytes.data(), bytes.size(), seed))
          << i << " bytes";
    bytes += static_cast<char>(i * 31 + i / 7);
  }
}

}  // namespace
}  // namespace rehearse
