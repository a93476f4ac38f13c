// rehearse golden noise: measures how much perturbed runs differ without a fault, and writes a file beside the golden.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/session.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/check/noise_floor.h"
#include "core/check/perturbed_run.h"
#include "core/guard/interruption.h"
#include "golden_verbs.h"
#include "options.h"
#include "progress.h"
#include "scratch_folder.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct GoldenNoiseSettings {
  std::vector<std::string> scenarios;
  std::optional<double> duration;  // [s]
  int patterns = 3;
  bool json = false;
  HostOptions host;
  PerturbedRun perturbed;  // the task of this process; without a folder: measure
  std::vector<std::string> levels;
};

/// The result of one scenario.
struct Measured {
  NoiseFloor noise;
  std::string file;       // output file; empty: not written
  std::string unwritten;  // the reason why it was not written
};

/// The file for the measurement, or the reason why it can't be stored.
Result<void> keep(const GoldenNoiseSettings& settings, const Scenario& scenario, const Trace& run, Measured& measured) {
  if (scenario.golden.empty()) return measured.unwritten = "the scenario names no golden", Result<void>();
  if (settings.duration) return measured.unwritten = "it was measured over another duration", Result<void>();
  const auto folder = REHEARSE_TRY(find_golden_folder(scenario.file));
  const GoldenStore store(folder);
  const fs::path golden = store.trace_file(scenario.golden);
  if (!store.has(scenario.golden)) return measured.unwritten = "there is no golden yet", Result<void>();
  const auto recorded = REHEARSE_TRY(Trace::load(golden));
  if (hash_of_recording(recorded) != hash_of_recording(run))
    return measured.unwritten = "the run differs from its golden: check it first", Result<void>();
  const fs::path file = noise_file_of(golden);
  REHEARSE_TRY(write_noise_floor(measured.noise, file));
  measured.file = file.string();
  return {};
}

Result<Measured> measure(const GoldenNoiseSettings& settings, const std::string& file) {
  auto scenario = REHEARSE_TRY(Scenario::load(file));
  if (settings.duration) scenario.duration = *settings.duration;
  StoppableProgress progress("measuring " + scenario.name);
  const ScratchFolder scratch(pending_folder() / "noise" / fmt::format("{}.{}", scenario.name, getpid()));
  std::error_code failed;
  fs::create_directories(scratch.path(), failed);
  if (failed) return error(fmt::format("the folder {} can't be made: {}", scratch.path().string(), failed.message()));
  RecordOptions running;
  static_cast<HostOptions&>(running) = settings.host;
  const fs::path trace = scratch.path() / "run.mcap";
  const auto run = REHEARSE_TRY(record(scenario, trace, running));
  if (interruption() != 0) throw Interrupted();
  if (run.failure) return *run.failure;
  const auto recording = REHEARSE_TRY(Trace::load(trace));
  NoiseOptions options;
  options.patterns = settings.patterns;
  options.host = settings.host;
  options.scratch = scratch.path() / "perturbed";
  options.program = fs::read_symlink("/proc/self/exe", failed);
  options.progress = [&](const std::string&, int done, int all) { progress.show(done, all); };
  auto noise = measure_noise(scenario, recording, {record, run_plant}, options);
  if (interruption() != 0) throw Interrupted();
  if (!noise) return noise.errors();
  Measured measured{*std::move(noise), "", ""};
  REHEARSE_TRY(keep(settings, scenario, recording, measured));
  return measured;
}

std::string number_text(const std::optional<double>& number) {
  return number ? fmt::format("{:.2g}", *number) : std::string("-");
}

/// Groups channels of one kind into one line: names of bodies and links differ, the last segment and the unit are
/// equal.
struct Line {
  std::string kind, unit;
  int channels = 0;
  std::optional<double> controller, plant;
  double tolerance = 0.0;

  double noise() const { return std::max(controller.value_or(0.0), plant.value_or(0.0)); }
};

std::vector<Line> grouped(const NoiseFloor& noise) {
  std::vector<Line> lines;
  for (const ChannelNoise& channel : noise.channels) {
    const bool commands = channel.controller.has_value();
    const std::size_t slash = channel.channel.rfind('/');
    const std::string kind = (commands ? "output/" : "") + channel.channel.substr(slash + 1);
    auto line = std::ranges::find_if(
        lines, [&](const Line& other) { return other.kind == kind && other.unit == channel.unit; });
    if (line == lines.end()) line = lines.insert(lines.end(), Line{kind, channel.unit, 0, {}, {}, channel.tolerance});
    ++line->channels;
    line->tolerance = std::min(line->tolerance, channel.tolerance);
    if (channel.controller) line->controller = std::max(line->controller.value_or(0.0), *channel.controller);
    if (channel.plant) line->plant = std::max(line->plant.value_or(0.0), *channel.plant);
  }
  return lines;
}

void tell(const Measured& measured) {
  const NoiseFloor& noise = measured.noise;
  fmt::print("{}: noise of {:g} s\n", noise.scenario, noise.duration);
  std::vector<TableRow> rows{{"channels", "unit", "controller", "plant", "tolerance", "over noise"}};
  for (const Line& line : grouped(noise)) {
    const std::string over = line.noise() > 0.0 ? fmt::format("{:.2g}", line.tolerance / line.noise()) : "-";
    rows.push_back({fmt::format("{} of {}", line.channels, line.kind), line.unit.empty() ? "-" : line.unit,
                    number_text(line.controller), number_text(line.plant), fmt::format("{:g}", line.tolerance), over});
  }
  print_table(rows);
  for (const Perturbation& perturbation : noise.perturbations) {
    if (!perturbation.not_made.empty()) {
      fmt::print("  {}: not made: {}\n", perturbation.name, perturbation.not_made);
      continue;
    }
    const std::string closed =
        !perturbation.closed   ? ""
        : perturbation.horizon ? fmt::format("; the closed loop leaves its tolerances at {:g} s", *perturbation.horizon)
                               : "; the closed loop stays within its tolerances";
    fmt::print("  {}: {}{}\n", perturbation.name,
               perturbation.beyond ? "beyond tolerance at " + to_string(*perturbation.beyond) : "within tolerance",
               closed);
  }
  if (noise.growth) fmt::print("  in the closed loop differences grow {:.2g} times a second\n", *noise.growth);
  if (measured.file.empty())
    fmt::print("  not kept: {}\n", measured.unwritten);
  else
    fmt::print("  wrote {}\n", measured.file);
}

template <class T>
Json json_of_optional(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json json_of_measured(const Measured& measured) {
  Json perturbations = Json::array(), channels = Json::array();
  for (const Perturbation& perturbation : measured.noise.perturbations)
    perturbations.push_back({{"name", perturbation.name},
                             {"made", perturbation.not_made.empty()},
                             {"why_not", perturbation.not_made},
                             {"within", !perturbation.beyond},
                             {"beyond", json_of(perturbation.beyond)},
                             {"closed", perturbation.closed},
                             {"horizon", json_of_optional(perturbation.horizon)}});
  for (const ChannelNoise& channel : measured.noise.channels)
    channels.push_back({{"channel", channel.channel},
                        {"unit", channel.unit},
                        {"controller", json_of_optional(channel.controller)},
                        {"plant", json_of_optional(channel.plant)},
                        {"tolerance", channel.tolerance}});
  return {{"scenario", measured.noise.scenario},
          {"duration", measured.noise.duration},
          {"horizon", json_of_optional(measured.noise.horizon())},
          {"growth", json_of_optional(measured.noise.growth)},
          {"perturbations", perturbations},
          {"channels", channels},
          {"file", measured.file.empty() ? Json(nullptr) : Json(measured.file)},
          {"not_kept", measured.unwritten}};
}

/// Executes the task that a parent process gave to this process.
Exit perturb(GoldenNoiseSettings& settings) {
  PerturbedRun& run = settings.perturbed;
  run.scenario = settings.scenarios[0];
  run.host = settings.host;
  run.duration = settings.duration.value_or(0.0);
  for (const std::string& level : settings.levels) {
    run.controller = run.controller || level == "controller";
    run.plant = run.plant || level == "plant";
    run.closed = run.closed || level == "closed";
  }
  const auto done = make_perturbed_run(run, {record, run_plant});
  return done ? Exit::done : refuse(done.errors());
}

Exit run_golden_noise(GoldenNoiseSettings& settings) {
  if (!settings.perturbed.folder.empty()) return perturb(settings);
  if (const auto allowed = check_may_decide(); !allowed) return refuse(allowed.errors());
  Json all = Json::array();
  for (const std::string& scenario : settings.scenarios) {
    const auto measured = measure(settings, scenario);
    if (!measured) return refuse(measured.errors());
    if (settings.json)
      all.push_back(json_of_measured(*measured));
    else
      tell(*measured);
  }
  if (settings.json) print(all.size() == 1 ? all[0] : Json{{"scenarios", all}});
  return Exit::done;
}

}  // namespace

std::function<Exit()> declare_golden_noise(CLI::App& options) {
  const auto settings = std::make_shared<GoldenNoiseSettings>();
  options.add_option("SCENARIO", settings->scenarios, "YAML files")->required()->type_name("");
  add_number(options, "--duration", "simulated time [s], instead of the scenario's; then nothing is written", 0.0,
             Scenario::max_duration, [=](double duration) { settings->duration = duration; });
  add_integer(options, "--patterns", "of last bits that are moved (3)", 1, 1000,
              [=](std::int64_t patterns) { settings->patterns = static_cast<int>(patterns); });
  add_host_options(options, settings->host);
  add_json_flag(options, settings->json);
  // options for child processes: in no group, so that --help doesn't list them
  options.add_option("--perturbed", settings->perturbed.folder)->group("");
  options.add_option("--recording", settings->perturbed.recording)->group("");
  options.add_option("--level", settings->levels)->group("")->allow_extra_args(false);
  return [settings] { return run_golden_noise(*settings); };
}

}  // namespace rehearse::tool
