#include "test_recordings.h"

#include <fmt/format.h>
#include <rehearse/session.h>

#include <map>
#include <utility>

#include "core/check/check_run.h"
#include "core/check/own_run.h"
#include "core/check/proof.h"
#include "core/trace/run_facts.h"
#include "realtime_assertions.h"

namespace rehearse::internal {
namespace {

namespace fs = std::filesystem;

/// A recording that this program made.
struct Recorded {
  std::string scenario;        // file
  fs::path golden;             // with which it can be compared; empty: none
  std::optional<Proof> proof;  // sought for the golden
  bool is_copy = false;        // of the golden
  bool is_whole = true;        // simulated from the first tick to the last
};

std::map<std::string, Recorded>& recordings() {
  static std::map<std::string, Recorded> by_file;
  return by_file;
}

const Recorded* find(const Trace& trace) {
  const auto found = recordings().find(trace.file());
  return found == recordings().end() ? nullptr : &found->second;
}

Result<RunSummary> own_record(const Scenario& scenario, const fs::path& file, const RecordOptions& options = {}) {
  return own_run([&]() -> Result<RunSummary> { return record(scenario, file, options); });
}

/// Simulates a run that is proved, and fails if it isn't the golden.
Result<RunSummary> simulate_proved(const Scenario& scenario, const fs::path& golden, const fs::path& file) {
  auto run = own_record(scenario, file);
  if (!run || run->ending()) return run;
  const auto compared = REHEARSE_TRY(compare(golden, file, scenario.tolerances, {}));
  if (compared.equal) return run;
  return error(fmt::format("the proof was wrong: it found no change since {}, but simulated: {}", golden.string(),
                           verdict(compared)));
}

/// Makes a run whose world is proved to make the golden.
Result<RunSummary> make_known(const Scenario& scenario, const std::string& test, const fs::path& file, int sampled,
                              Recorded& recorded) {
  const auto golden = Trace::load_in_pieces(recorded.golden, [](const Trace&) {});
  if (!golden) return own_record(scenario, file);  // the comparison reports the error
  auto level = replay_golden(scenario, *golden, with_controllers_of(scenario, {}));
  ReplayReport* const replayed = level ? &level->replay : nullptr;
  if (!replayed || !replayed->repeats_the_run) {
    auto run = REHEARSE_TRY(make_run(scenario, *golden, replayed, file, {}, simulation()));
    recorded.is_whole = run.from == 0;
    return std::move(run.summary);
  }
  const auto chosen = REHEARSE_TRY(is_sampled(test, sampled));
  if (chosen) return simulate_proved(scenario, recorded.golden, file);
  std::error_code failed;
  fs::copy_file(recorded.golden, file, fs::copy_options::overwrite_existing, failed);
  if (failed)
    return error(
        fmt::format("{} can't be copied to {}: {}", recorded.golden.string(), file.string(), failed.message()));
  recorded.is_copy = true;
  RunSummary copied;
  copied.ticks = replayed->ticks;
  copied.remarks = std::move(replayed->remarks);
  return copied;
}

}  // namespace

Simulation simulation() {
  const auto simulated = [](const Scenario& scenario, const fs::path& trace, const RecordOptions& options) {
    return record(scenario, trace, options);  // of session.h; the one of gtest.h has the same name
  };
  return {simulated, run_plant, describe_plant, record_from};
}

ToleranceRule equal_bits() {
  ToleranceRule rule;
  rule.channel = "*";
  rule.atol = rule.rtol = rule.pixel_share = rule.pixel_delta = rule.pixel_window = 0.0;
  return rule;
}

fs::path certificates_of(const GoldenStore& store) { return store.where_runs_wait() / "proofs"; }

Result<RunSummary> make_recording(const Scenario& scenario, const std::string& test, const fs::path& file) {
  const GoldenStore store = golden_store();
  const auto proving = REHEARSE_TRY(proof_mode());
  const auto mode = REHEARSE_TRY(golden_mode());
  Recorded& recorded = recordings()[file.string()];
  recorded = {scenario.file, {}, std::nullopt};
  RecordOptions counting;
  counting.counts_costs = wants_realtime();
  if (counting.counts_costs) return own_record(scenario, file, counting);
  if (!proving.on || mode != GoldenMode::check || !store.has(test)) return own_record(scenario, file);
  recorded.golden = store.trace_file(test);
  const auto golden = Trace::outline(recorded.golden);
  if (!golden || !check_version(*golden)) return own_record(scenario, file);  // the comparison reports the error
  if (RunFacts::of(*golden).state_rate) return own_record(scenario, file);    // the test may read the state of any tick
  CheckOptions options;
  options.certificates = certificates_of(store);
  recorded.proof.emplace(scenario, *golden, options, simulation());
  if (!recorded.proof->holds()) return own_record(scenario, file);
  return make_known(scenario, test, file, proving.sampled, recorded);
}

std::string scenario_file_of(const Trace& trace) {
  const Recorded* recorded = find(trace);
  return recorded ? recorded->scenario : "";
}

bool is_proved(const Trace& trace) {
  const Recorded* recorded = find(trace);
  return recorded && recorded->is_copy;
}

Result<void> certify(const Trace& trace, const std::vector<ToleranceRule>& rules) {
  const Recorded* recorded = find(trace);
  if (!recorded || !recorded->proof || recorded->proof->holds() || !recorded->is_whole) return {};
  const auto compared = REHEARSE_TRY(compare(recorded->golden, trace.file(), rules, {}));
  return compared.equal ? recorded->proof->certify() : Result<void>();
}

}  // namespace rehearse::internal
