// The memory of a recording, of a comparison of two, and of the choice of a part does not depend on their length. (For
// an hour see the page contribute/robustness_tests.md.)
#include "recording_process.h"

#include <sys/resource.h>

#include "../harness/small_traces.h"

namespace rehearse::test {
namespace {

/// The largest memory of the program [kB]; -1 if it ends with another status.
long peak_memory(const std::vector<std::string>& words, const fs::path& log, int expected_status = 0) {
  const pid_t child = start(words, log);
  int status = 0;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  return WIFEXITED(status) && WEXITSTATUS(status) == expected_status ? usage.ru_maxrss : -1;
}

/// A pendulum under a controller that counts its calls; its hinge begins at that angle [degrees].
void write_pendulum(const fs::path& scenario, const fs::path& calls, int hinge) {
  std::ofstream(scenario) << "rehearse: 1\nduration: 60\nbodies:\n  - name: Pendulum\n    model: "
                          << (fs::path(FIXTURES_DIR) / "models/pendulum.urdf").string()
                          << "\n    joints: {hinge: " << hinge
                          << " deg}\n    controllers:\n      - name: Ticking\n        library: " << TICKING
                          << "\n        options: \"" << calls.string() << " 0\"\n";
}

TEST(Memory, OfARecordingDoesNotGrowWithItsLength) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const TemporaryFolder scratch;
  const CallCounter counter(scratch.path() / "calls");
  const fs::path scenario = scratch.path() / "pendulum.yaml", trace = scratch.path() / "run.mcap";
  write_pendulum(scenario, scratch.path() / "calls", 20);
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

TEST(Memory, OfAComparisonOrAPartDoesNotGrowWithTheLength) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const TemporaryFolder scratch;
  const CallCounter counter(scratch.path() / "calls");
  const auto record = [&](int hinge, const std::string& seconds) {
    const fs::path scenario = scratch.path() / "pendulum.yaml";
    const std::string trace = (scratch.path() / (std::to_string(hinge) + "_" + seconds + ".mcap")).string();
    write_pendulum(scenario, scratch.path() / "calls", hinge);
    EXPECT_GT(peak_memory({REHEARSE_COMMAND, "record", scenario.string(), "-o", trace, "--duration", seconds},
                          scratch.path() / "log"),
              0)
        << read_file(scratch.path() / "log");
    return trace;
  };
  const auto diff = [&](const std::string& golden, const std::string& actual, int status) {
    return peak_memory({REHEARSE_COMMAND, "diff", golden, actual}, scratch.path() / "log", status);
  };
  // The brief ones are larger than what a reader leaves mapped of a file that it passes.
  const std::string brief = record(20, "100"), lengthy = record(20, "300");
  const std::string brief_unlike = record(21, "100"), lengthy_unlike = record(21, "300");
  constexpr long growth = 12 * 1024;  // [kB]; 200 s more are 40 MB more of trace
  const long equal = diff(brief, brief, 0), unlike = diff(brief, brief_unlike, 1);
  ASSERT_GT(equal, 0) << read_file(scratch.path() / "log");
  ASSERT_GT(unlike, 0) << read_file(scratch.path() / "log");
  const long lengthy_equal = diff(lengthy, lengthy, 0), lengthy_differing = diff(lengthy, lengthy_unlike, 1);
  EXPECT_GT(lengthy_equal, 0);
  EXPECT_LT(lengthy_equal, equal + growth);
  EXPECT_GT(lengthy_differing, 0);
  EXPECT_LT(lengthy_differing, unlike + growth);

  const auto filter = [&](const std::string& trace) {
    const std::string part = trace + ".part";
    return peak_memory({REHEARSE_COMMAND, "filter", trace, "-o", part, "--from", "50", "--until", "60"},
                       scratch.path() / "log");
  };
  const long lengthy_filtered = filter(lengthy);
  EXPECT_GT(lengthy_filtered, 0) << read_file(scratch.path() / "log");
  EXPECT_LT(lengthy_filtered, filter(brief) + growth);
}

/// A recording with so many lines of a controller; `last`: the text of the last one. Another process writes it, because
/// a child's largest memory includes that of this process at its start.
std::string write_lines(const fs::path& trace, std::int64_t lines, const std::string& last) {
  constexpr std::int64_t ticks = 1000;
  const pid_t child = fork();
  if (child == 0) {
    testing::SmallTrace run;
    run.scenario =
        "rehearse: 1\nduration: 1\nbodies: [{name: Ball, sphere: {radius: 0.1}, mass: 1, position: [0, 0, 9]}]\n";
    run.lengthen(ticks);
    for (std::int64_t i = 0; i < lines; ++i) {
      const std::int64_t tick = ticks * i / lines;
      run.events.push_back({msg::Time::from_ns(static_cast<std::uint64_t>(tick) * 1'000'000), tick, "note", "Robot/Pd",
                            i + 1 < lines ? "line " + std::to_string(i) + " of many" : last});
    }
    run.write(trace);
    _exit(0);
  }
  EXPECT_EQ(waitpid(child, nullptr, 0), child);
  return trace.string();
}

TEST(Memory, OfLinesDoesNotGrowWithTheirNumber) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const TemporaryFolder scratch;
  const auto kilobytes = [&](const std::vector<std::string>& words, int status) {
    std::vector<std::string> all{REHEARSE_COMMAND};
    all.insert(all.end(), words.begin(), words.end());
    const long peak = peak_memory(all, scratch.path() / "log", status);
    EXPECT_GT(peak, 0) << words[0] << ": " << read_file(scratch.path() / "log");
    return peak;
  };
  constexpr std::int64_t few = 10'000, many = 210'000;
  std::vector<std::vector<long>> peaks;
  for (const std::int64_t lines : {few, many}) {
    const std::string name = std::to_string(lines);
    const std::string golden = write_lines(scratch.path() / (name + ".golden.mcap"), lines, "the end");
    const std::string run = write_lines(scratch.path() / (name + ".mcap"), lines, "another end");
    peaks.push_back({kilobytes({"info", "--full", run}, 0), kilobytes({"info", "--json", run}, 0),
                     kilobytes({"diff", golden, run}, 0),
                     kilobytes({"report", golden, run, "-o", (scratch.path() / "report.html").string()}, 0)});
  }
  // A msg::Event takes 200 bytes of memory, and its JSON 1000: 200,000 more lines of two runs would take 80 and 400 MB.
  // A report keeps the times and places of the messages of both; a comparison has some megabytes of both at a time.
  const std::vector<long> growth{12 * 1024, 16 * 1024, 32 * 1024, 40 * 1024};  // [kB]
  const std::vector<std::string> verbs{"info --full", "info --json", "diff", "report"};
  for (std::size_t i = 0; i < verbs.size(); ++i) EXPECT_LT(peaks[1][i], peaks[0][i] + growth[i]) << verbs[i];
}

/// A sheet of so many triangles, as binary STL.
void write_sheet(const fs::path& file, std::uint32_t triangles) {
  std::ofstream stream(file, std::ios::binary);
  const auto put = [&stream](const auto& value) { stream.write(reinterpret_cast<const char*>(&value), sizeof value); };
  stream << std::string(80, ' ');
  put(triangles);
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float x = static_cast<float>(i % 1000), y = static_cast<float>(i) / 1000;
    for (const float number : {0.0F, 0.0F, 1.0F, x, y, 0.0F, x + 1, y, 0.0F, x, y + 1, 0.0F}) put(number);
    put(std::uint16_t{0});
  }
}

TEST(Memory, OfAMeshThatIsReadIsThreeTimesItsFile) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  const TemporaryFolder scratch;
  const auto kilobytes = [&](std::uint32_t triangles) {
    write_sheet(scratch.path() / "sheet.stl", triangles);
    std::ofstream(scratch.path() / "sheet.urdf")
        << "<robot name='sheet'><link name='sheet'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
           "ixz='0' iyz='0'/></inertial><visual><geometry><mesh "
           "filename='sheet.stl'/></geometry></visual></link></robot>";
    const fs::path scenario = scratch.path() / "sheet.yaml";
    std::ofstream(scenario) << "rehearse: 1\nduration: 0.001\nbodies: [{name: B, model: sheet.urdf}]\n";
    const long peak =
        peak_memory({REHEARSE_COMMAND, "record", scenario.string(), "-o", (scratch.path() / "run.mcap").string()},
                    scratch.path() / "log");
    EXPECT_GT(peak, 0) << read_file(scratch.path() / "log");
    return peak;
  };
  constexpr std::uint32_t few = 100'000, many = 400'000;
  constexpr long more = (many - few) * 50 / 1024;  // of the file [kB]
  const long brief = kilobytes(few);
  EXPECT_LT(kilobytes(many), brief + 3 * more);
}

}  // namespace
}  // namespace rehearse::test
