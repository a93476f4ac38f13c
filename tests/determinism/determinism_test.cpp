// The same scenario gives the same bytes, whatever is different around it.

#include <rehearse/session.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

struct Case {
  const char* name;
  const char* scenario;
  const char* seconds;
};
void PrintTo(const Case& recorded, std::ostream* stream) { *stream << recorded.name; }

class Determinism : public ::testing::TestWithParam<Case> {
 protected:
  Determinism() : folder_(fs::path(::testing::TempDir()) / ("rehearse_determinism_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Determinism() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  static fs::path scenario_file(const char* name) { return fs::path(FIXTURES_DIR) / "scenarios" / name; }

  static Scenario load(const char* name, const char* seconds) {
    auto scenario = Scenario::load(scenario_file(name));
    EXPECT_TRUE(scenario.ok());
    scenario->duration = std::atof(seconds);
    return *std::move(scenario);
  }
  static Scenario load() { return load(GetParam().scenario, GetParam().seconds); }

  std::string bytes(const std::string& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }

  std::string record_here(const Scenario& scenario, const std::string& file) const {
    const auto summary = record(scenario, folder_ / file);
    EXPECT_TRUE(summary.ok() && !summary->failure);
    return bytes(file);
  }

  /// Records in a process of its own; `around` comes before its command line: variables, setarch, env.
  std::string record_there(const std::string& around = "") const {
    const std::string command = "cd / && " + around + " '" PROBE "' '" + scenario_file(GetParam().scenario).string() +
                                "' " + GetParam().seconds + " '" + (folder_ / "there.mcap").string() + "'";
    fs::remove(folder_ / "there.mcap");
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    const std::string made = bytes("there.mcap");
    EXPECT_GT(made.size(), 5000u);
    return made;
  }

  /// Told as a position, since no one can read a difference of megabytes.
  static void expect_same(const std::string& a, const std::string& b) {
    ASSERT_EQ(a.size(), b.size());
    const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin());
    EXPECT_EQ(in_a, a.end()) << "the first byte that differs is number " << in_a - a.begin();
  }

  fs::path folder_;
};

INSTANTIATE_TEST_SUITE_P(Of, Determinism,
                         ::testing::Values(Case{"sr1", "sr1_minimum.yaml", "0.3"},
                                           Case{"drop_box", "drop_box.yaml", "1"}),
                         [](const auto& of) { return std::string(of.param.name); });

TEST_P(Determinism, TwiceInOneProcess) { expect_same(record_here(load(), "a.mcap"), record_here(load(), "b.mcap")); }

TEST_P(Determinism, AfterAnotherWorld) {
  const std::string alone = record_here(load(), "a.mcap");
  const bool is_sr1 = GetParam().name == std::string("sr1");
  record_here(is_sr1 ? load("drop_box.yaml", "1") : load("sr1_minimum.yaml", "0.1"), "other.mcap");
  expect_same(record_here(load(), "b.mcap"), alone);
}

TEST_P(Determinism, TickByTickBesideAnotherWorld) {
  const std::string alone = record_here(load(), "a.mcap");
  const Scenario ours = load(), other = load("drop_box.yaml", "10");
  auto our_session = Session::create(ours, folder_ / "b.mcap", {});
  auto other_session = Session::create(other, folder_ / "other.mcap", {});
  ASSERT_TRUE(our_session.ok() && other_session.ok());
  while (*(*our_session)->step()) ASSERT_TRUE((*other_session)->step().ok());
  ASSERT_TRUE((*our_session)->finish().ok());
  expect_same(bytes("b.mcap"), alone);
}

TEST_P(Determinism, InTwoProcesses) {
  const std::string first = record_there();
  expect_same(first, record_there());
}

TEST_P(Determinism, WithAnotherEnvironmentAndWorkingFolder) {
  const std::string plain = record_there();
  const std::string much = std::string(100000, 'x');
  expect_same(record_there("MUCH=" + much), plain);
  // what a sanitized build was told of others' leaks must reach it all the same
  const std::string sanitizer = R"(${LSAN_OPTIONS:+"LSAN_OPTIONS=$LSAN_OPTIONS"})";
  expect_same(record_there("cd /usr/share && env -i " + sanitizer + " LANG=de_DE.UTF-8 LC_ALL=de_DE.UTF-8 TZ=Asia/Tokyo"), plain);
}

TEST_P(Determinism, WithOtherContentsOfFreshMemory) {
  const std::string plain = record_there();
  expect_same(record_there("MALLOC_PERTURB_=85"), plain);
  expect_same(record_there("MALLOC_PERTURB_=170"), plain);
}

TEST_P(Determinism, WithOtherAddresses) {
  if (std::system("setarch -R true 2>/dev/null") != 0) GTEST_SKIP() << "setarch -R is not permitted here";
  const std::string plain = record_there();
  expect_same(record_there("setarch -R"), plain);
  expect_same(record_there("MALLOC_ARENA_MAX=1 MALLOC_TOP_PAD_=65536 MALLOC_MMAP_THRESHOLD_=4096"), plain);
}

TEST_P(Determinism, PinnedWhateverTheUserHasSet) {
  const std::string plain = record_there();
  // what would change mathematics and pixels if it came through
  expect_same(record_there("GALLIUM_OVERRIDE_CPU_CAPS=sse2 LP_NUM_THREADS=2"), plain);
}

}  // namespace
}  // namespace rehearse
