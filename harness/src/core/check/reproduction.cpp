#include <fmt/format.h>
#include <rehearse/check.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "check_run.h"
#include "core/compare/tick_clock.h"
#include "core/kinds/channel_name.h"
#include "core/replay/plant_level.h"
#include "core/trace/trace_windows.h"
#include "own_run.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The spans that are simulated again: first tick, and end.
std::vector<std::pair<std::int64_t, std::int64_t>> sample_spans(const Trace& recording, double time_step, int wanted) {
  std::vector<std::int64_t> ends;  // checkpoints, and the end of the recording
  const auto tick_of = [&](std::uint64_t time) {
    return static_cast<std::int64_t>(std::llround(static_cast<double>(time) * 1e-9 / time_step));
  };
  if (const TraceChannel* checkpoints = recording.find_channel(run_topics::checkpoint))
    for (const std::uint64_t time : checkpoints->times) ends.push_back(tick_of(time));
  const TickClock clock(recording);
  if (!clock.empty() && (ends.empty() || ends.back() < tick_of(clock.last_time())))
    ends.push_back(tick_of(clock.last_time()));
  std::vector<std::pair<std::int64_t, std::int64_t>> spans;
  const std::int64_t all = std::ssize(ends) - 1, some = std::min<std::int64_t>(all, wanted);
  std::set<std::int64_t> chosen;
  for (std::int64_t i = 0; i < some; ++i) chosen.insert(some == 1 ? 0 : i * (all - 1) / (some - 1));
  for (const std::int64_t number : chosen) spans.emplace_back(ends[number], ends[number + 1]);
  return spans;
}

/// The test of one recording.
struct Trial {
  const Scenario& scenario;
  const Trace& recording;
  const fs::path& scratch;
  const ReproductionOptions& options;
  const Simulation& simulation;
  Reproduction result;

  Result<void> replay_controllers();
  Result<void> simulate_spans();
  Result<std::string> simulate(std::int64_t from, std::optional<std::int64_t> until);
  std::string text() const;
};

Result<void> Trial::replay_controllers() {
  const ReplayOptions replaying = as_here(options);
  const auto replayed = REHEARSE_TRY(own_replay(recording.file(), replaying));
  result.replayed = replayed.ticks;
  result.failure = replayed.failure;
  result.first = replayed.first;
  return {};
}

/// Simulates one span and compares it. Returns the reason why no checkpoint could be used; empty if one was used.
Result<std::string> Trial::simulate(std::int64_t from, std::optional<std::int64_t> until) {
  PlantOptions running;
  running.from = from;
  running.until = until;
  running.resync = false;
  REHEARSE_TRY(make_folder_of(scratch));
  const auto run = REHEARSE_TRY(simulation.run_plant(scenario, recording, scratch, running));
  result.simulated += run.ticks;
  ++result.spans;
  result.failure = run.failure;
  const auto part = REHEARSE_TRY(Trace::load(scratch));
  CompareOptions exact;
  exact.stages = stages_of_plant;
  result.first = compare(overlap(recording, part), part, {}, exact).first_bit;
  return run.from_the_start;
}

Result<void> Trial::simulate_spans() {
  const auto spans = sample_spans(recording, scenario.time_step, options.spans);
  bool whole = spans.empty();
  for (std::size_t i = 0; i < spans.size() && !whole && result.reproduced(); ++i) {
    if (options.progress) options.progress(static_cast<std::int64_t>(i), std::ssize(spans));
    const auto [from, until] = spans[i];
    const auto from_the_start = REHEARSE_TRY(simulate(from, until));
    whole = !from_the_start.empty();
  }
  if (whole && result.reproduced()) {
    result.spans = 0;
    REHEARSE_TRY(simulate(0, std::nullopt));
  }
  std::error_code ignored;
  fs::remove(scratch, ignored);
  return {};
}

std::string Trial::text() const {
  if (result.failure) return "the recording doesn't repeat itself: " + result.failure->message;
  if (result.first && (result.first->stage == Stage::controller || result.first->stage == Stage::inputs))
    return fmt::format(
        "the recording doesn't repeat itself: fed with its inputs, the controller differs at {}; `rehearse audit` "
        "finds the cause",
        to_string(*result.first));
  if (result.first)
    return fmt::format("the recording doesn't repeat itself: under its commands, the world differs at {}",
                       to_string(*result.first));
  return fmt::format(
      "the recording repeats itself, bit for bit: the commands of {} ticks on its inputs, and {} ticks of simulation "
      "in {} {}",
      result.replayed, result.simulated, result.spans, result.spans == 1 ? "span" : "spans from its checkpoints");
}

}  // namespace

Result<Reproduction> reproduce(const Scenario& scenario, const Trace& recording, const fs::path& scratch,
                               const ReproductionOptions& options, const Simulation& given) {
  Simulation simulation = given;
  simulation.run_plant = own_plant(std::move(simulation.run_plant));
  Trial trial{scenario, recording, scratch, options, simulation, {}};
  REHEARSE_TRY(trial.replay_controllers());
  if (trial.result.reproduced()) REHEARSE_TRY(trial.simulate_spans());
  trial.result.verdict = trial.text();
  return std::move(trial.result);
}

}  // namespace rehearse
