// Code that affects physics, sensors and traces must not depend on the order of addresses or of hashes, on a clock, on
// random numbers, on the environment or on other threads. This test searches the sources of engine/ and harness/ for
// such code. Exceptions are listed in `allowed`, with the reason; an exception that is no longer needed fails the test,
// too.
#include <gtest/gtest.h>
#include <regex.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {
namespace {

namespace fs = std::filesystem;

struct Rule {
  const char* name;
  const char* pattern;  // extended regular expression of a line without its comment and texts
  const char* why;
  const char* unless = nullptr;  // a line that has this as well is right
};

const Rule rules[] = {
    {"unordered", R"(\bunordered_(multi)?(map|set)\b)", "its order is that of hashes, and changes with the library"},
    {"pointer order", R"(\bstd::(multi)?(map|set)<[^,<>]*\*\s*[,>])", "its order is that of addresses"},
    {"hash", R"(\bstd::hash\b|\bhash_value\()", "it may be another number with another library; see hashing.h"},
    {"unstable sort", R"(\b(std::|ranges::)(sort|partial_sort|nth_element)\()",
     "what compares equal comes out in any order: take std::stable_sort, or order completely and say so here",
     R"(\.end\(\)\);|ranges::sort\([^,]*\);)"},  // by operator<, which is a complete order for what we sort so
    {"clock",
     R"(\b(steady|system|high_resolution|utc|file)_clock\b|\b(clock_gettime|gettimeofday|std::time|std::clock|localtime|gmtime)\()",
     "no run may depend on when it is made or how long it takes"},
    {"chance",
     R"(\b(s?rand|s?random|drand48|getrandom|arc4random)\(|\brandom_device\b|\bmt19937|\bdefault_random_engine\b)",
     "a run has a seed, and each world and each noise a generator of its own"},
    {"environment", R"(\b(secure_)?getenv\()", "the same scenario gives the same run wherever it is made"},
    {"thread", R"(\bstd::j?thread\b|\bstd::async\b|\bpthread_create\()", "a run is computed by one thread"},
    {"identity", R"(\bgetpid\(|\bgettid\(|\bthis_thread::get_id\(|\bgethostname\()", "it is another one in each run"},
};

struct Exception {
  const char* file;  // below the repository
  const char* rule;
  const char* reason;
};

const Exception allowed[] = {
    {"engine/src/renderer/closed_surface.cpp", "unstable sort",
     "the directions of equal edges are added up, as whole numbers"},
    {"engine/src/mesh/convex_hull.cpp", "unstable sort", "points by all their coordinates; of equal ones one is kept"},
    {"engine/src/mesh/mesh_paths.cpp", "environment",
     "where packages and meshes lie; what was found stands in the trace"},
    {"engine/src/mesh/package_search.cpp", "environment", "where packages lie; what was found stands in the trace"},
    {"engine/src/base/user_cache.cpp", "environment", "where hulls and hashes are kept; they are the same everywhere"},
    {"engine/src/base/user_cache.cpp", "identity", "names a file until it is complete"},
    {"engine/src/renderer/renderer_gl.cpp", "environment",
     "threads of the renderer: a picture is the same without them"},
    {"engine/src/urdf/urdf_materials.h", "pointer order", "only looked up, never walked"},
    {"engine/src/world/world.cpp", "chance", "OwnRandom puts the world's own generator in the place of that of ODE"},
    {"harness/src/audit/interposer/system_calls.cpp", "chance",
     "the C library's answers for an audited controller that asks the kernel itself"},
    {"harness/src/audit/interposer/system_calls.cpp", "clock", "the same"},
    {"harness/src/audit/interposer/system_calls.cpp", "identity", "the same"},
    {"harness/src/audit/interposer/waiting.cpp", "clock",
     "how long an audited controller really waits; nothing is recorded there"},
    {"harness/src/audit/interposer/watching.cpp", "environment", "the orders of an audited process"},
    {"harness/src/campaigns/run/sweep.cpp", "clock", "how long a case took; no other member of a result depends on it"},
    {"harness/src/core/guard/worker_pool.cpp", "identity", "the worker asks whether its parent is still there"},
    {"harness/src/core/guard/worker_pool.cpp", "clock", "when a case counts as hung"},
    {"harness/src/core/golden/acceptance.cpp", "clock", "the date of an acceptance, written for people"},
    {"engine/src/base/file_identity.cpp", "clock", "whether a file has to be read again; its hash is the same"},
    {"harness/src/core/golden/acceptance.cpp", "environment", "SOURCE_DATE_EPOCH instead of that date"},
    {"harness/src/audit/audit/audited_replay.cpp", "chance",
     "other addresses, on purpose, from the number of the replay"},
    {"harness/src/audit/audit/experiments.cpp", "environment", "which locale is another one"},
    {"harness/src/core/host/interposer.cpp", "environment", "what is loaded into an audited process"},
    {"harness/src/fuzz/fuzzing/fuzz_search.cpp", "clock",
     "when a search ends that was given a time; no run depends on it"},
    {"harness/src/fuzz/fuzzing/fuzz_test.cpp", "environment", "how long a test searches"},
    {"harness/src/gtest/testing/realtime_assertions.cpp", "environment",
     "whether a test program's runs must be real-time safe; no run depends on it"},
    {"harness/src/audit/audit/judgement.cpp", "unstable sort", "factors, of which there is one each"},
    {"harness/src/audit/audit/replay_process.cpp", "clock", "when an audited process counts as hung"},
    {"harness/src/core/host/virtualised.cpp", "environment",
     "whether this process was given simulated time; the trace says so"},
    {"harness/src/core/compare/compare_events.cpp", "unstable sort",
     "spans that are blanked: their union is what counts"},
    {"harness/src/core/host/controller_library.cpp", "environment",
     "where controllers lie; the trace has the file's hash"},
    {"harness/src/core/host/source_age.cpp", "identity", "names a file until it is complete"},
    {"harness/src/core/golden/golden.cpp", "environment", "what is done with a finished run"},
    {"harness/src/gtest/testing/gtest_support.cpp", "environment", "what is done with a finished run"},
    {"harness/src/core/guard/child_process.cpp", "clock", "when a program that doesn't answer is stopped"},
    {"harness/src/core/guard/child_process.cpp", "environment", "PATH, for programs such as gdb"},
    {"harness/src/core/guard/interruption.cpp", "clock",
     "whether a signal came twice at once: decides how a process ends"},
    {"harness/src/core/guard/interruption.cpp", "identity", "who sent the signal: decides how a process ends"},
    {"harness/src/core/guard/pin.cpp", "environment", "how a process is pinned"},
    {"harness/src/core/guard/pinned_environment.cpp", "environment", "how a process is pinned"},
    {"harness/src/core/host/call_clock.cpp", "clock", "how long control() takes; no recording contains it"},
    {"harness/src/core/guard/process_end.cpp", "identity", "a child that a guest forks in exit() tells nothing"},
    {"harness/src/core/guard/supervisor.cpp", "clock",
     "the parent process: decides when a child is killed, never what is in a run"},
    {"harness/src/core/guard/supervisor.cpp", "environment", "whether there is a parent; the recording is the same"},
    {"harness/src/core/keeper/trace_keeper.h", "thread",
     "in the parent: writes the calls that it receives, in their order"},
    {"harness/src/core/guard/supervisor.cpp", "identity", "the child asks whether its parent is still there"},
    {"harness/src/core/guard/process_tripwires.cpp", "identity",
     "a controller's child asks whether its parent is still there"},
    {"harness/src/core/guard/process_tripwires.cpp", "thread",
     "counts the threads that controllers start; starts none"},
    {"harness/src/core/guard/turn_clocks.cpp", "clock", "gives threads of controllers the time of the simulation"},
    {"harness/src/core/guard/turn_system_calls.cpp", "clock", "calls by number go through the same functions"},
    {"harness/src/core/guard/turn_locks.cpp", "pointer order", "barriers are only looked up, never walked"},
    {"harness/src/core/guard/watchdog.cpp", "clock", "decides whether a run goes on, never what is in it"},
    {"harness/src/core/guard/watchdog.cpp", "thread", "ends calls that are late"},
    {"harness/src/choreonoid/import/project_files.cpp", "environment",
     "where a project's files below HOME lie; the scenario names what was found"},
    {"harness/src/choreonoid/import/project_run.h", "pointer order", "only looked up, never walked"},
    {"harness/src/core/replay/recorded_files.cpp", "environment",
     "where controllers find recorded copies of files; a file that is there is read as it is"},
    {"harness/src/core/recording/provenance.cpp", "environment", "what the trace says of how the process was pinned"},
    {"harness/src/viewing/report/call_stack.cpp", "environment", "whether a report has a call stack"},
    {"harness/src/viewing/live/served_recording.cpp", "clock", "how fast viewers get a recording that is finished"},
    {"harness/src/viewing/live/web_server.cpp", "chance", "tokens, which no stranger may guess"},
    {"harness/src/viewing/live/web_server.cpp", "clock", "when a connection that is silent ends"},
    {"harness/src/viewing/ui/project_checks.cpp", "clock", "how long builds and checks took, and when; no run sees it"},
    {"harness/src/viewing/ui/project_checks.h", "clock", "the same"},
    {"harness/src/viewing/report/report.cpp", "thread", "waits for gdb while the report of a finished run is written"},
    {"harness/src/viewing/report/report_page.cpp", "environment", "where the page of reports lies"},
    {"harness/src/gtest/testing/test_folders.cpp", "environment", "where a test's files lie"},
    {"harness/src/gtest/testing/test_history.cpp", "environment", "where the history of finished runs lies"},
    {"harness/src/gtest/testing/test_reports.cpp", "environment", "what is done with a finished run"},
    {"harness/src/gtest/testing/test_process.cpp", "clock", "how long a test took, for the index of tests"},
    {"harness/src/core/mcap/output.h", "thread", "compresses and writes; what it writes depends on the data alone"},
    {"harness/src/core/compare/compared_files.cpp", "thread",
     "reads one of the two recordings; what is read depends on the data alone"},
    {"engine/src/base/quiet_thread.h", "thread",
     "starts it, and the one that opens chunks: what it gives depends on the data alone"},
    {"harness/src/core/check/proof.cpp", "environment", "whether a check simulates what it could prove"},
    {"harness/src/core/check/proof.cpp", "identity", "names a file until it is complete"},
    {"harness/src/logs/bag/conversion.cpp", "identity", "names a file until SQLite has opened it"},
    {"harness/src/core/recording/mathematics.cpp", "environment",
     "which functions the C library took, beside those of a robot's loop; it only explains a difference"},
    {"harness/src/logs/flight/flight.cpp", "clock",
     "when the recorder of a robot's loop looks for ticks, and writes to the disk; no tick has it"},
};

/// The line's code: no text, no comment.
std::string code_of(const std::string& line) {
  std::string code;
  bool in_text = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (in_text && line[i] == '\\') {
      ++i;
    } else if (line[i] == '"') {
      in_text = !in_text;
      code += '"';
    } else if (!in_text) {
      if (line.compare(i, 2, "//") == 0) break;
      code += line[i];
    }
  }
  return code;
}

/// A regular expression of the C library: many times faster than std::regex, and there are many lines.
class Pattern {
 public:
  explicit Pattern(const char* text) { EXPECT_EQ(regcomp(&expression_, text, REG_EXTENDED | REG_NOSUB), 0) << text; }
  ~Pattern() { regfree(&expression_); }
  Pattern(const Pattern&) = delete;
  Pattern& operator=(const Pattern&) = delete;
  bool is_in(const std::string& line) const { return regexec(&expression_, line.c_str(), 0, nullptr, 0) == 0; }

 private:
  regex_t expression_{};
};

struct Finding {
  std::string file;
  int line = 0;
  const Rule* rule = nullptr;
};

std::vector<Finding> findings_in(const std::string& file, std::istream& stream) {
  static const auto patterns = [] {
    std::vector<std::pair<std::unique_ptr<Pattern>, std::unique_ptr<Pattern>>> all;
    for (const Rule& rule : rules)
      all.emplace_back(std::make_unique<Pattern>(rule.pattern),
                       rule.unless ? std::make_unique<Pattern>(rule.unless) : nullptr);
    return all;
  }();
  std::vector<Finding> found;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::string code = code_of(line);
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      const auto& [pattern, unless] = patterns[i];
      if (pattern->is_in(code) && !(unless && unless->is_in(code))) found.push_back({file, number, &rules[i]});
    }
  }
  return found;
}

std::vector<Finding> all_findings() {
  std::vector<Finding> found;
  const fs::path root = fs::path(FIXTURES_DIR).parent_path();
  int files = 0;
  for (const char* room : {"engine", "harness"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / room)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      ++files;
      std::ifstream stream(entry.path());
      const auto in_file = findings_in(entry.path().lexically_relative(root).string(), stream);
      found.insert(found.end(), in_file.begin(), in_file.end());
    }
  }
  EXPECT_GT(files, 100) << "are these the sources?";
  return found;
}

bool allows(const Exception& exception, const Finding& finding) {
  return finding.file == exception.file && finding.rule->name == std::string(exception.rule);
}

TEST(Lint, NothingUnorderedNoClockAndNoChanceFeedsARun) {
  for (const Finding& finding : all_findings()) {
    const bool is_allowed =
        std::ranges::any_of(allowed, [&](const Exception& exception) { return allows(exception, finding); });
    if (!is_allowed)
      ADD_FAILURE() << finding.file << ":" << finding.line << ": " << finding.rule->name << ": " << finding.rule->why;
  }
}

TEST(Lint, AllowsNothingThatIsGone) {
  const std::vector<Finding> found = all_findings();
  for (const Exception& exception : allowed)
    EXPECT_TRUE(std::ranges::any_of(found, [&](const Finding& finding) { return allows(exception, finding); }))
        << exception.file << " has no '" << exception.rule << "' any more";
}

struct Sample {
  const char* code;
  const char* rule;  // null: none
};
class LintRule : public ::testing::TestWithParam<Sample> {};

INSTANTIATE_TEST_SUITE_P(
    Of, LintRule,
    ::testing::Values(Sample{"std::unordered_map<std::string, int> links;", "unordered"},
                      Sample{"  std::map<const Body*, int> order;", "pointer order"},
                      Sample{"std::set<Link *> seen;", "pointer order"}, Sample{"std::map<int, Body*> by_id;", nullptr},
                      Sample{"seed = std::hash<std::string>()(name);", "hash"},
                      Sample{"std::ranges::sort(a, by_depth);", "unstable sort"},
                      Sample{"std::nth_element(a.begin(), middle, a.end(), by_depth);", "unstable sort"},
                      Sample{"std::nth_element(a.begin(), middle, a.end());", nullptr},
                      Sample{"std::ranges::sort(a, [](int x, int y) {", "unstable sort"},
                      Sample{"std::ranges::sort(a);", nullptr},
                      Sample{"std::ranges::stable_sort(a, by_depth);", nullptr},
                      Sample{"const auto now = std::chrono::steady_clock::now();", "clock"},
                      Sample{"clock_gettime(CLOCK_MONOTONIC, &now);", "clock"}, Sample{"time_of(tick, step)", nullptr},
                      Sample{"std::mt19937 generator;", "chance"}, Sample{"int i = rand();", "chance"},
                      Sample{"dRandSetSeed(0); // not rand()", nullptr}, Sample{"std::getenv(\"HOME\")", "environment"},
                      Sample{"std::thread worker(run);", "thread"}, Sample{"error(\"std::thread failed\")", nullptr},
                      Sample{"name += std::to_string(getpid());", "identity"}));

TEST_P(LintRule, FindsWhatItIsFor) {
  std::istringstream stream(GetParam().code);
  const std::vector<Finding> found = findings_in("sample.cpp", stream);
  if (!GetParam().rule) {
    EXPECT_TRUE(found.empty()) << found[0].rule->name;
  } else {
    ASSERT_EQ(found.size(), 1u);
    EXPECT_STREQ(found[0].rule->name, GetParam().rule);
  }
}

}  // namespace
}  // namespace rehearse
