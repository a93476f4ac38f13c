// A recording takes the same memory however long it is. (An hour: tests/README.md.)
#include "recording_process.h"

#include <sys/resource.h>

namespace rehearse::test {
namespace {

/// What the program takes at most [kB]; -1 if it fails.
long peak_memory(const std::vector<std::string>& words, const fs::path& log) {
  const pid_t child = start(words, log);
  int status = 0;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? usage.ru_maxrss : -1;
}

TEST(Memory, OfARecordingDoesNotGrowWithItsLength) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const Scratch scratch;
  const CallCounter counter(scratch.path() / "calls");
  const fs::path scenario = scratch.path() / "pendulum.yaml", trace = scratch.path() / "run.mcap";
  std::ofstream(scenario) << "rehearse: 1\nduration: 60\nbodies:\n  - name: Pendulum\n    model: "
                          << (fs::path(FIXTURES_DIR) / "models/pendulum.urdf").string()
                          << "\n    joints: {hinge: 20 deg}\n    controllers:\n      - name: Ticking\n        library: "
                          << TICKING << "\n        options: \"" << (scratch.path() / "calls").string() << " 0\"\n";
  const auto record = [&](const std::string& seconds) {
    return peak_memory({REHEARSE_COMMAND, "record", scenario.string(), "-o", trace.string(), "--duration", seconds},
                       scratch.path() / "log");
  };
  const long brief = record("10"), lengthy = record("60");
  ASSERT_GT(brief, 0) << read_file(scratch.path() / "log");
  ASSERT_GT(lengthy, 0) << read_file(scratch.path() / "log");
  constexpr long growth = 4 * 1024;  // [kB]; 50 s more are 10 MB more of trace, and 30 kB of them the writer's index
  EXPECT_LT(lengthy, brief + growth);
  constexpr long most = 100 * 1024;  // [kB]
  EXPECT_LT(lengthy, most);

  const long whole =
      peak_memory({REHEARSE_COMMAND, "recover", trace.string(), "-o", (scratch.path() / "saved.mcap").string()},
                  scratch.path() / "log");
  EXPECT_GT(whole, 0);
  EXPECT_LT(whole, most);
}

}  // namespace
}  // namespace rehearse::test
