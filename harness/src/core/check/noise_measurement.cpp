// Measures noise: perturbs runs and compares them with the recording.
#include <fmt/format.h>
#include <rehearse/pin.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/clock.h"
#include "core/compare/series_rules.h"
#include "core/recording/provenance.h"
#include "core/trace/run_facts.h"
#include "noise_floor.h"
#include "perturbed_run.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double incomparable = 1e300;  // a number against NaN or infinity

#if defined(__x86_64__)
bool has_sse4_1() { return __builtin_cpu_supports("sse4.1"); }
bool has_avx() { return __builtin_cpu_supports("avx"); }
#else
bool has_sse4_1() { return false; }
bool has_avx() { return false; }
#endif

bool of_controller(const ChannelComparison& channel) { return channel.stage == Stage::controller; }

class NoiseMeasurement {
 public:
  NoiseMeasurement(const Scenario& scenario, const Trace& recording, const Simulation& simulation,
                   const NoiseOptions& options)
      : scenario_(scenario), recording_(recording), simulation_(simulation), options_(options) {}

  Result<NoiseFloor> measure();

 private:
  struct Step {
    Perturbation perturbation;
    std::optional<std::uint32_t> nudge;  // none: made by a process of its own
    EnvironmentChanges environment;
    bool of_mathematics = false;  // no perturbation if the process computes equal bits
  };

  void list_channels();
  std::vector<Step> plan() const;
  bool has_pictures() const;
  Result<void> nudged(Step& step);
  Result<void> in_another_process(Step& step);
  Result<void> take_plant(const fs::path& trace, Perturbation& perturbation);
  Result<void> take_closed(const fs::path& trace, Perturbation& perturbation);
  void take(const std::vector<ChannelComparison>& channels);
  ChannelNoise& place(const std::string& channel, const std::string& unit);

  const Scenario& scenario_;
  const Trace& recording_;
  const Simulation& simulation_;
  const NoiseOptions& options_;
  NoiseFloor floor_;
};

ChannelNoise& NoiseMeasurement::place(const std::string& channel, const std::string& unit) {
  const auto found = std::ranges::find_if(
      floor_.channels, [&](const ChannelNoise& noise) { return noise.channel == channel && noise.unit == unit; });
  if (found != floor_.channels.end()) return *found;
  ChannelNoise& added = floor_.channels.emplace_back();
  added.channel = channel;
  added.unit = unit;
  added.tolerance = std::numeric_limits<double>::infinity();
  return added;
}

/// Lists all compared channels with the tolerances in force, also those that no perturbation changes.
void NoiseMeasurement::list_channels() {
  CompareOptions what;
  what.stages = {Stage::physics, Stage::sensors, Stage::renderer, Stage::controller};
  const Comparison itself = compare(recording_, recording_, scenario_.tolerances, what);
  for (const ChannelComparison& channel : itself.same) {
    for (const SeriesComparison& series : channel.series) {
      ChannelNoise& noise = place(channel.channel, series.unit);
      noise.tolerance = std::min(noise.tolerance, series.tolerance);
      (of_controller(channel) ? noise.controller : noise.plant) = 0.0;
    }
  }
}

bool NoiseMeasurement::has_pictures() const {
  return std::ranges::any_of(recording_.channels(),
                             [](const TraceChannel& channel) { return is_picture(channel) && channel.messages() > 0; });
}

/// The perturbations, including those that can't be made on this machine.
std::vector<NoiseMeasurement::Step> NoiseMeasurement::plan() const {
  std::vector<Step> steps;
  const auto add = [&](std::string name, bool controller, bool closed) -> Step& {
    Step& step = steps.emplace_back();
    step.perturbation.name = std::move(name);
    step.perturbation.controller = controller;
    step.perturbation.plant = true;
    step.perturbation.closed = closed && options_.closed;
    return step;
  };
  for (int pattern = 1; pattern <= options_.patterns; ++pattern)
    add(fmt::format("last bits, pattern {}", pattern), false, true).nudge = static_cast<std::uint32_t>(pattern);
  Step& mathematics = add("C library not pinned", true, true);
  mathematics.environment = {{"GLIBC_TUNABLES", std::nullopt}};
  mathematics.of_mathematics = true;
  if (!is_pinned()) mathematics.perturbation.not_made = "this process isn't pinned itself";
  const bool pictures = has_pictures();
  const auto draw_otherwise = [&](const char* name, std::optional<std::string> code, bool possible, const char* lacks) {
    Step& step = add(name, false, false);
    step.environment = {{"GALLIUM_OVERRIDE_CPU_CAPS", std::move(code)}};
    if (!pictures)
      step.perturbation.not_made = "no camera of the scenario runs";
    else if (!possible)
      step.perturbation.not_made = lacks;
  };
  draw_otherwise("renderer of SSE2", "sse2", has_sse4_1(), "this processor has no SSE4.1");
  draw_otherwise("renderer of all that the processor has", std::nullopt, has_avx(), "this processor has no AVX");
  return steps;
}

void NoiseMeasurement::take(const std::vector<ChannelComparison>& channels) {
  for (const ChannelComparison& channel : channels) {
    for (const SeriesComparison& series : channel.series) {
      std::optional<double>& noise = place(channel.channel, series.unit).plant;
      const double largest = std::isfinite(series.largest) ? series.largest : incomparable;
      noise = std::max(noise.value_or(0.0), largest);
    }
  }
}

Result<void> NoiseMeasurement::take_plant(const fs::path& file, Perturbation& perturbation) {
  const auto trace = REHEARSE_TRY(Trace::load(file));
  CompareOptions what;
  what.stages = {Stage::physics, Stage::sensors, Stage::renderer};
  const Comparison comparison = compare(recording_, trace, scenario_.tolerances, what);
  take(comparison.channels);
  if (comparison.first && !perturbation.beyond) perturbation.beyond = comparison.first;
  std::error_code ignored;
  fs::remove(file, ignored);
  return {};
}

/// The largest difference of a position or angle until a time.
double strayed_until(const Trace& recording, const Trace& trace, double time) {
  CompareOptions what;
  what.stages = {Stage::physics};
  what.until = time;
  double largest = 0.0;
  for (const ChannelComparison& channel : compare(recording, trace, {}, what).channels)
    for (const SeriesComparison& series : channel.series)
      if ((series.unit == "m" || series.unit == "rad") && series.largest > largest) largest = series.largest;
  return largest;
}

Result<void> NoiseMeasurement::take_closed(const fs::path& file, Perturbation& perturbation) {
  const auto trace = REHEARSE_TRY(Trace::load(file));
  const Comparison comparison = compare(recording_, trace, scenario_.tolerances);
  if (comparison.first) perturbation.horizon = comparison.first->time;
  const double end = perturbation.horizon.value_or(recording_.duration());
  const double half = strayed_until(recording_, trace, 0.5 * end), whole = strayed_until(recording_, trace, end);
  const double growth = half > 0.0 && end > 0.0 ? std::pow(whole / half, 2.0 / end) : 1.0;
  if (growth > 2.0) floor_.growth = std::max(floor_.growth.value_or(growth), growth);
  std::error_code ignored;
  fs::remove(file, ignored);
  return {};
}

Result<void> NoiseMeasurement::nudged(Step& step) {
  PlantOptions moving;
  moving.nudge = step.nudge;
  const fs::path file = options_.scratch / "perturbed.mcap";
  const auto plant = REHEARSE_TRY(simulation_.run_plant(scenario_, recording_, file, moving));
  if (plant.failure) return *plant.failure;
  REHEARSE_TRY(take_plant(file, step.perturbation));
  if (!step.perturbation.closed) return {};
  RecordOptions running;
  static_cast<HostOptions&>(running) = options_.host;
  running.nudge = step.nudge;
  const auto closed = REHEARSE_TRY(simulation_.record(scenario_, file, running));
  if (closed.failure) return *closed.failure;
  return take_closed(file, step.perturbation);
}

Result<void> NoiseMeasurement::in_another_process(Step& step) {
  Perturbation& perturbation = step.perturbation;
  PerturbedRun run;
  run.scenario = scenario_.file;
  run.recording = recording_.file();
  run.folder = options_.scratch;
  run.duration = scenario_.duration;
  run.controller = perturbation.controller;
  run.plant = perturbation.plant;
  run.closed = perturbation.closed;
  run.host = options_.host;
  const auto outcome = REHEARSE_TRY(run_perturbed_process(options_.program, run, step.environment));
  if (step.of_mathematics && outcome.same_mathematics)
    perturbation.not_made = "without the pin, the C library computes the same bits on this processor";
  for (const auto& [where, difference] : outcome.commands) {
    std::optional<double>& noise = place(where.first, where.second).controller;
    noise = std::max(noise.value_or(0.0), difference);
  }
  perturbation.beyond = outcome.beyond;
  if (run.plant) REHEARSE_TRY(take_plant(run.folder / "plant.mcap", perturbation));
  if (run.closed) REHEARSE_TRY(take_closed(run.folder / "closed.mcap", perturbation));
  std::error_code ignored;
  fs::remove(run.folder / "report.json", ignored);
  return {};
}

Result<NoiseFloor> NoiseMeasurement::measure() {
  floor_.scenario = scenario_.name;
  floor_.recording = hash_of_recording(recording_);
  floor_.duration = time_of(scenario_.ticks(), scenario_.time_step);
  if (const auto provenance = RunFacts::of(recording_).provenance)
    for (const char* fact : noise_facts)
      if (const auto found = provenance->find(fact); found != provenance->end()) floor_.made_with.insert(*found);
  list_channels();
  std::vector<Step> steps = plan();
  int done = 0;
  for (Step& step : steps) {
    if (options_.progress) options_.progress(step.perturbation.name, done, static_cast<int>(steps.size()));
    ++done;
    if (step.perturbation.not_made.empty()) {
      REHEARSE_TRY(step.nudge ? nudged(step) : in_another_process(step));
    }
    floor_.perturbations.push_back(std::move(step.perturbation));
  }
  return std::move(floor_);
}

}  // namespace

Result<NoiseFloor> measure_noise(const Scenario& scenario, const Trace& recording, const Simulation& simulation,
                                 const NoiseOptions& options) {
  std::error_code failed;
  fs::create_directories(options.scratch, failed);
  if (failed) return error(fmt::format("the folder {} can't be made: {}", options.scratch.string(), failed.message()));
  return NoiseMeasurement(scenario, recording, simulation, options).measure();
}

}  // namespace rehearse
