// Runs a corpus, and simple mutations of it, through a fuzz target's entry function: with any compiler, in every build.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::vector<std::uint8_t> read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// In the order of their names, so that a failure comes again.
std::set<std::filesystem::path> corpus() {
  const std::filesystem::directory_iterator entries(CORPUS_DIR);
  return {begin(entries), end(entries)};
}

#ifdef __SANITIZE_ADDRESS__
constexpr std::size_t positions = 100;  // in each file; CI also runs libFuzzer with sanitizers from the same corpora
#else
constexpr std::size_t positions = 400;
#endif

}  // namespace

TEST(FUZZ_SUITE, GetsThroughItsCorpus) {
  ASSERT_FALSE(corpus().empty()) << CORPUS_DIR;
  for (const auto& file : corpus()) {
    SCOPED_TRACE(file);
    const auto bytes = read(file);
    EXPECT_EQ(LLVMFuzzerTestOneInput(bytes.data(), bytes.size()), 0);
  }
}

TEST(FUZZ_SUITE, GetsThroughMutationsOfItsCorpus) {
  for (const auto& file : corpus()) {
    SCOPED_TRACE(file);
    const auto whole = read(file);
    const std::size_t step = whole.size() / positions + 1;
    for (std::size_t i = 0; i < whole.size(); i += step) {
      auto bytes = whole;
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ 0xff);
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
      bytes.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(i));
      LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    }
  }
}
