// rehearse fit: fits numbers of a scenario to recordings of a robot, and compares the fits to two of them.
#include <fmt/format.h>
#include <rehearse/fit.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "command.h"
#include "core/guard/interruption.h"
#include "options.h"
#include "output.h"
#include "progress.h"
#include "side_by_side.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct FitSettings {
  std::vector<std::string> recordings;
  std::string scenario, output, judge;
  std::vector<std::string> vary;
  FitOptions options;
  std::int64_t jobs = 0;
  bool wear = false;
  bool force = false;
  bool json = false;
};

/// "PATH" or "PATH=LOW..HIGH".
FitRequest request_of(const std::string& word) {
  FitRequest request;
  const std::size_t equals = word.rfind('=');
  request.path = word.substr(0, equals);
  if (equals == std::string::npos) return request;
  const std::string bounds = word.substr(equals + 1);
  const std::size_t dots = bounds.find("..");
  if (dots == std::string::npos)
    throw CLI::ValidationError("--vary", fmt::format("{} has no bounds: expected PATH=LOW..HIGH", in_quotes(word)));
  constexpr double most = 1e11;
  request.low = parse_number("--vary", bounds.substr(0, dots), -most, most);
  request.high = parse_number("--vary", bounds.substr(dots + 2), -most, most);
  return request;
}

/// Digits up to a tenth of the interval's half.
std::string text_of(double value, const FittedNumber& number) {
  const double half = 0.5 * (number.high - number.low);
  if (!(half > 0.0) || !std::isfinite(half)) return fmt::format("{:.6g}", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(half)));
  return decimals > 9 || decimals < 0 ? fmt::format("{:.6g}", value) : fmt::format("{:.{}f}", value, decimals);
}

std::string interval_of(const FittedNumber& number) {
  return fmt::format("{} to {}", text_of(number.low, number), text_of(number.high, number));
}

std::string with_unit(const std::string& text, const FittedNumber& number) {
  return number.unit.empty() ? text : text + " " + number.unit;
}

void tell_undecided(const FittedNumber& number) {
  if (number.is_identified()) return;
  fmt::print("{} isn't identifiable: {}\n", number.path, number.reason);
  if (!number.advice.empty()) fmt::print("  what could decide it: {}\n", number.advice);
}

void tell(const FitResult& result) {
  std::vector<TableRow> rows{{"number", "fitted", "95 % interval", "was"}};
  for (const FittedNumber& number : result.numbers)
    if (number.is_identified())
      rows.push_back({number.path, with_unit(text_of(number.value, number), number), interval_of(number),
                      fmt::format("{:.6g}", number.was)});
  if (rows.size() > 1) print_table(rows);
  for (const FittedNumber& number : result.numbers) tell_undecided(number);
  for (const FitCorrelation& one : result.correlations)
    fmt::print("{} and {} are correlated by {:.3f}: their errors go together\n", one.a, one.b, one.correlation);
  fmt::print("the differences are {:.2f} times the noise; before {:.2f} times; compared stretches: {}\n", result.after,
             result.before, result.stretches);
  const auto worst = std::ranges::max_element(result.series, {}, &FitSeriesResidual::after);
  if (worst != result.series.end() && worst->after > 1.5)
    fmt::print("most of what is left is in {} of {}: {:.2f} times its noise, {:.3g}\n", worst->series, worst->recording,
               worst->after, worst->noise);
  if (result.has_complete_states)
    fmt::print("states: complete, from checkpoints\n");
  else
    fmt::print("states: estimated from the joints\n");
}

Json number_or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

Json json_of(const FittedNumber& number) {
  return {{"path", number.path},
          {"unit", number.unit},
          {"identified", number.is_identified()},
          {"value", number_or_null(number.value)},
          {"interval", number.is_identified() ? Json{number.low, number.high} : Json(nullptr)},
          {"was", number.was},
          {"bounds", {number.bound_low, number.bound_high}},
          {"reason", number.reason},
          {"advice", number.advice}};
}

Json json_of(const FitResult& result) {
  Json numbers = Json::array(), correlations = Json::array(), series = Json::array();
  for (const FittedNumber& number : result.numbers) numbers.push_back(json_of(number));
  for (const FitCorrelation& one : result.correlations)
    correlations.push_back({{"a", one.a}, {"b", one.b}, {"correlation", one.correlation}});
  for (const FitSeriesResidual& one : result.series)
    series.push_back({{"recording", one.recording},
                      {"series", one.series},
                      {"noise", one.noise},
                      {"before", one.before},
                      {"after", one.after}});
  return {{"numbers", std::move(numbers)},     {"correlations", std::move(correlations)},
          {"before", result.before},           {"after", result.after},
          {"series", std::move(series)},       {"stretches", result.stretches},
          {"evaluations", result.evaluations}, {"states", result.has_complete_states ? "complete" : "estimated"}};
}

Result<FitResult> fitted(FitSettings& settings, const std::vector<std::string>& recordings) {
  Progress progress("fitting");
  constexpr std::int64_t usual = 60;  // evaluations
  settings.options.progress = [&](std::int64_t evaluations) {
    progress.show(evaluations, std::max(usual, evaluations + 1));
  };
  return fit(settings.scenario, recordings, settings.options);
}

Exit refuse_unless_interrupted(const Diagnostics& problems) {
  if (interruption() != 0) return static_cast<Exit>(128 + interruption());
  return refuse(problems);
}

/// Why the fitted scenario can't be written there.
Result<void> check_output(const FitSettings& settings) {
  if (settings.output.empty()) return {};
  std::error_code failed;
  const auto folder_of = [&](const fs::path& file) {
    const fs::path folder = file.parent_path();
    return fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, failed);
  };
  if (folder_of(settings.output) != folder_of(settings.scenario))
    return error_in(settings.output,
                    "it isn't in the folder of the scenario, from which the scenario's files are found",
                    fmt::format("name a file in {}", folder_of(settings.scenario).string()));
  if (fs::exists(settings.output, failed) && fs::equivalent(settings.output, settings.scenario, failed))
    return error_in(settings.output, "it is the scenario itself");
  if (fs::exists(settings.output, failed) && !settings.force)
    return error_in(settings.output, "it exists", "--force replaces it");
  return {};
}

std::string fitted_text(const FitSettings& settings, const FitResult& result) {
  std::string text =
      fmt::format("# {} with numbers that were fitted to", fs::path(settings.scenario).filename().string());
  for (const std::string& recording : settings.recordings) text += " " + fs::path(recording).filename().string();
  text += ":\n";
  for (const FittedNumber& number : result.numbers)
    if (number.is_identified())
      text += fmt::format("#   {}: {} ({}), was {:.6g}\n", number.path, text_of(number.value, number),
                          interval_of(number), number.was);
  return text + result.text;
}

Exit run_plain(FitSettings& settings) {
  const auto result = fitted(settings, settings.recordings);
  if (!result) return refuse_unless_interrupted(result.errors());
  std::optional<FitJudgement> judgement;
  if (!settings.judge.empty()) {
    const auto judged = judge_fit(settings.scenario, *result, settings.judge, settings.options);
    if (!judged) return refuse_unless_interrupted(judged.errors());
    judgement = *judged;
  }
  const bool is_written = !settings.output.empty() && result->identifies_any();
  if (is_written)
    if (const auto written = write_text(settings.output, fitted_text(settings, *result)); !written)
      return refuse(written.errors());
  if (settings.json) {
    Json object = json_of(*result);
    object["judgement"] =
        judgement ? Json{{"recording", settings.judge}, {"before", judgement->before}, {"after", judgement->after}}
                  : Json(nullptr);
    object["file"] = is_written ? Json(settings.output) : Json(nullptr);
    print(object);
  } else {
    tell(*result);
    if (judgement)
      fmt::print("{}: {:.2f} times its noise; before {:.2f} times\n", settings.judge, judgement->after,
                 judgement->before);
    if (is_written) fmt::print("wrote {}\n", settings.output);
  }
  return result->identifies_any() ? Exit::done : Exit::odd;
}

/// "grew from 0.8 (0.75 to 0.85) to 1.3 (1.25 to 1.35)".
std::string change_of(const WornNumber& number) {
  const FittedNumber& a = number.earlier;
  const FittedNumber& b = number.later;
  return fmt::format("{} from {} ({}) to {} ({})", b.value > a.value ? "grew" : "fell", text_of(a.value, a),
                     interval_of(a), with_unit(text_of(b.value, b), b), interval_of(b));
}

void tell_wear(const std::vector<WornNumber>& numbers) {
  int moved = 0, decided = 0;
  for (const WornNumber& number : numbers) {
    if (number.has_moved)
      fmt::print("{} {} (p = {:.2g})\n", number.earlier.path, change_of(number), number.probability);
    moved += number.has_moved ? 1 : 0;
    decided += number.earlier.is_identified() && number.later.is_identified() ? 1 : 0;
  }
  for (const WornNumber& number : numbers)
    tell_undecided(number.earlier.is_identified() ? number.later : number.earlier);
  if (decided == 0) return;
  if (moved > 0)
    fmt::print("the robot changed: {} of {} moved beyond both intervals\n", moved, count_text(decided, "number"));
  else
    fmt::print("nothing moved beyond both intervals, of {}\n", count_text(decided, "number"));
}

Exit run_wear(FitSettings& settings) {
  const auto earlier = fitted(settings, {settings.recordings[0]});
  if (!earlier) return refuse_unless_interrupted(earlier.errors());
  const auto later = fitted(settings, {settings.recordings[1]});
  if (!later) return refuse_unless_interrupted(later.errors());
  const std::vector<WornNumber> numbers = wear(*earlier, *later);
  const auto is_decided = [](const WornNumber& one) {
    return one.earlier.is_identified() && one.later.is_identified();
  };
  const bool has_moved = std::ranges::any_of(numbers, &WornNumber::has_moved);
  if (settings.json) {
    Json list = Json::array();
    for (const WornNumber& number : numbers)
      list.push_back({{"earlier", json_of(number.earlier)},
                      {"later", json_of(number.later)},
                      {"probability", is_decided(number) ? Json(number.probability) : Json(nullptr)},
                      {"moved", number.has_moved}});
    print({{"wear", std::move(list)}, {"earlier", json_of(*earlier)}, {"later", json_of(*later)}});
  } else {
    tell_wear(numbers);
  }
  if (has_moved) return Exit::differs;
  return std::ranges::any_of(numbers, is_decided) ? Exit::done : Exit::odd;
}

Exit run_fit(FitSettings& settings) {
  end_runs_on_signals();
  if (settings.wear && settings.recordings.size() != 2)
    return refuse(error(fmt::format("--wear compares two recordings, not {}", settings.recordings.size())));
  for (const std::string& word : settings.vary) settings.options.vary.push_back(request_of(word));
  settings.options.jobs = settings.jobs > 0 ? static_cast<std::size_t>(settings.jobs) : processors();
  if (const auto allowed = check_output(settings); !allowed) return refuse(allowed.errors());
  return settings.wear ? run_wear(settings) : run_plain(settings);
}

std::function<Exit()> declare_fit(CLI::App& options) {
  const auto settings = std::make_shared<FitSettings>();
  options.add_option("RECORDING", settings->recordings, "recordings of the robot")->required()->type_name("");
  options.add_option("--scenario", settings->scenario, "the scenario whose numbers are fitted")
      ->required()
      ->type_name("FILE");
  options
      .add_option("--vary", settings->vary,
                  "paths of numbers, as in vary: of a scenario; =LOW..HIGH states bounds (those in vary:, else a tenth "
                  "of the stated number to ten times it)")
      ->required()
      ->type_name("PATH[=LOW..HIGH]");
  add_number(options, "--horizon", "compared time of a stretch (0.05) [s]", 1e-4, 10.0,
             [settings](double horizon) { settings->options.horizon = horizon; });
  add_integer(options, "--bootstrap", "intervals from so many drawn sets of stretches (from the curvature)", 20,
              100'000, [settings](std::int64_t sets) { settings->options.bootstrap = static_cast<int>(sets); });
  options
      .add_option("--judge", settings->judge, "a recording that the fit doesn't use: its differences before and after")
      ->type_name("RECORDING");
  options.add_flag("--wear", settings->wear, "fit two recordings, and say which numbers moved between them")
      ->excludes("--judge");
  options.add_option("-o,--output", settings->output, "the scenario to write, with the identified numbers")
      ->type_name("FILE")
      ->excludes("--wear");
  options.add_flag("--force", settings->force, "replace that file");
  add_integer(options, "-j,--jobs", "processes (one for each processor)", 1, 1024,
              [settings](std::int64_t jobs) { settings->jobs = jobs; });
  add_json_flag(options, settings->json);
  return [settings] { return run_fit(*settings); };
}

}  // namespace

extern const Verb fit_verb{
    "fit",
    "  rehearse fit flight.mcap --scenario walk.yaml --vary bodies.Walker.actuators[0].coulomb\n"
    "  rehearse fit flight.mcap --scenario walk.yaml --vary 'bodies.Walker.actuators[0].delay=0..0.02' "
    "-o fitted.yaml\n"
    "  rehearse fit --wear monday.mcap friday.mcap --scenario walk.yaml --vary "
    "bodies.Walker.actuators[0].coulomb\n",
    declare_fit};

}  // namespace rehearse::tool
