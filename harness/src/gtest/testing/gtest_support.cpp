// The implementation of <rehearse/gtest.h>, without GoogleTest.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/gtest.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <cstdlib>
#include <map>
#include <set>
#include <stdexcept>

#include "base/names.h"
#include "core/check/own_run.h"
#include "core/golden/run_folder.h"
#include "core/host/source_age.h"
#include "core/scenario/trace_scenario.h"
#include "realtime_assertions.h"
#include "test_recordings.h"
#include "test_reports.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;

/// A file for each recording of a test, because traces stay open as long as the test uses them. It is in a folder of
/// this process, because a different process may run the same test.
fs::path new_trace_file(const std::string& test) {
  static std::map<std::string, int> recorded;
  static std::map<fs::path, Result<RunFolder>> folders;  // by parent folder
  const int number = ++recorded[test];
  const auto [folder, is_new] = folders.try_emplace(traces_folder(), RunFolder::make(traces_folder()));
  if (!folder->second) throw std::runtime_error(to_string(folder->second.errors()));
  return folder->second->path() / (number == 1 ? test + ".mcap" : fmt::format("{}-{}.mcap", test, number));
}

/// Publishes the test's last trace under its final name, when it is complete.
void publish(const fs::path& trace) {
  const fs::path draft = fs::path(trace).concat(".kept");
  std::error_code failed;
  fs::create_hard_link(trace, draft, failed);
  if (failed) fs::copy_file(trace, draft, fs::copy_options::overwrite_existing, failed);
  if (!failed) fs::rename(draft, traces_folder() / trace.filename(), failed);
}

/// Prints repairs and warnings on stderr, each once in a process.
void print_warnings(const Diagnostics& found) {
  static std::set<std::string> printed;
  for (const Diagnostic& warning : found)
    if ((warning.severity == Severity::repair || warning.severity == Severity::warning) &&
        printed.insert(to_string(warning)).second)
      fmt::print(stderr, "{}\n", to_string(warning));
}

}  // namespace

GoldenStore golden_store() {
  const TestFolders folders = test_folders();
  const bool stated = std::getenv("REHEARSE_PENDING") != nullptr;
  return GoldenStore(folders.golden, stated ? pending_folder() : fs::path(folders.output) / "goldens" / "pending");
}

namespace {

/// Ends the test, which is in the index as one that did not run.
[[noreturn]] void fail_to_run(const std::string& test, const std::string& message) {
  TestResult result;
  result.test = test;
  result.kind = "run";
  result.state = TestResult::State::failed;
  result.verdict = message.substr(0, message.find('\n'));
  throw std::runtime_error(message + keep_test_result(std::move(result), nullptr, {}));
}

}  // namespace

Trace record_for_test(const std::string& scenario_file, const std::string& test) {
  const auto scenario = Scenario::load(fixture_path(scenario_file));
  if (!scenario) fail_to_run(test, to_string(scenario.errors()));
  print_warnings(scenario->warnings);
  tell_old_libraries(notes_on_old_libraries(*scenario, {}));
  const fs::path file = new_trace_file(test);
  const auto run = make_recording(*scenario, test, file);
  if (!run) fail_to_run(test, to_string(run.errors()));
  publish(file);
  print_warnings(run->remarks);
  if (run->failure)
    fail_to_run(test, fmt::format("{}\nthe trace up to there: {}", to_string(*run->failure),
                                  (traces_folder() / file.filename()).string()));
  if (run->controller_refused) fail_to_run(test, to_string(run->remarks));
  if (wants_realtime())
    if (const TestVerdict verdict = judge_realtime(run->control_times); !verdict.passed)
      fail_to_run(test, fmt::format("{}the lines: rehearse audit --realtime {}", verdict.message,
                                    (traces_folder() / file.filename()).string()));
  drop_test_result(test, "run");
  auto trace = Trace::load(file);
  if (!trace) throw std::runtime_error(to_string(trace.errors()));
  return std::move(*trace);
}

namespace {

/// Remarks to append to a verdict, each on a line.
std::string remarks_text(const ReplayReport& report) {
  std::string text;
  for (const Diagnostic& remark : report.remarks) text += "\n" + to_string(remark);
  return text;
}

/// Advice on the missing golden of a replay.
std::string advice_on(const std::string& name, const GoldenStore& store) {
  const std::vector<std::string> near = near_names(name, store.names());
  return near.empty() ? fmt::format("the run of a test becomes one, EXPECT_MATCHES_GOLDEN, or a recording: rehearse "
                                    "golden accept {} --recording FILE",
                                    name)
                      : near_hint(near, store.names(), "goldens");
}

/// `differing`: set to the result of a replay with other commands.
TestVerdict replay_and_compare(const GoldenStore& store, const std::string& name,
                               std::optional<ReplayReport>& differing) {
  report_golden_owner(store, name, "EXPECT_REPLAYS");
  if (!store.has(name))
    return {false, fmt::format("there is no golden {}; {}", store.trace_file(name).string(), advice_on(name, store))};
  if (const auto golden = mcap::Reader::open(store.trace_file(name)))
    if (const auto scenario = scenario_of(**golden)) tell_old_libraries(notes_on_old_libraries(*scenario, {}));
  const auto report = own_replay(store.trace_file(name), {});
  if (!report) return {false, to_string(report.errors())};
  if (report->failure) return {false, report->failure->message};
  if (report->values == 0)
    return {false, fmt::format("nothing was compared: no controller commands anything in {}",
                               store.trace_file(name).string())};
  if (!report->first) return {true, ""};
  if (report->is_allowed()) {
    fmt::print("{}\n", headline(*report, "the rules for commands allow the differences: "));
    return {true, ""};
  }
  if (report->is_rounding()) {
    fmt::print("within its tolerance: {}; {}\n", headline(*report), report->other_mathematics);
    return {true, ""};
  }
  differing = *report;
  return {
      false,
      fmt::format(
          "the controller gives other commands: {}\n  {} of {} ticks differ, from tick {} on, on the inputs of {}{}",
          headline(*report, "", "it "), report->ticks_different, report->ticks, report->first->tick,
          store.trace_file(name).string(), remarks_text(*report))};
}

}  // namespace

namespace {

/// The report of a replay that differs, and its entry in the index: the replay becomes a recording beside the golden.
/// `within`: only bits differ.
std::string keep_replay_report(const fs::path& golden, const std::string& test, const TestVerdict& verdict,
                               bool within) {
  const fs::path file = traces_folder() / (test + ".replay.mcap");
  std::error_code ignored;
  fs::create_directories(traces_folder(), ignored);
  const auto written = own_run([&]() -> Result<void> { return write_replay(golden, file, {}); });
  if (!written) return "\n" + to_string(written.errors());
  const auto replayed = Trace::load(file);
  if (!replayed) return "\n" + to_string(replayed.errors());
  ComparedTest compared;
  compared.golden = golden;
  auto tolerances = tolerances_of(*replayed);
  if (!tolerances) return "\n" + to_string(tolerances.errors());
  compared.tolerances = *std::move(tolerances);
  compared.differs_in_bits_alone = within;
  return keep_test_report(*replayed, test, "replay", verdict, compared);
}

}  // namespace

TestVerdict replay_golden(const std::string& name, const std::string& test) {
  const GoldenStore store = golden_store();
  std::optional<ReplayReport> differing;
  TestVerdict verdict = replay_and_compare(store, name, differing);
  if (differing) {
    verdict.message += keep_replay_report(store.trace_file(name), test, verdict, differing->within());
    return verdict;
  }
  TestResult result;
  result.test = test;
  result.kind = "replay";
  result.state = verdict.passed ? TestResult::State::passed : TestResult::State::failed;
  result.verdict =
      verdict.passed ? "the golden's commands, bit for bit" : verdict.message.substr(0, verdict.message.find('\n'));
  const std::string told = keep_test_result(std::move(result), nullptr, {});
  if (!verdict.passed) verdict.message += told;
  return verdict;
}

}  // namespace rehearse::internal
