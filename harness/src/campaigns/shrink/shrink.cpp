// The smallest change of the nominal scenario that fails like a case.
#include <fmt/format.h>
#include <rehearse/shrink.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/text.h"
#include "campaigns/run/case_run.h"
#include "core/golden/golden_files.h"
#include "core/guard/interruption.h"
#include "core/scenario/scenario_variations.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Indices = std::vector<std::size_t>;

constexpr int halvings = 8;          // of the distance to the nominal value
constexpr double least_move = 0.02;  // of this distance; a smaller one doesn't count as a change

Indices without(const Indices& all, std::size_t begin, std::size_t end) {
  Indices rest(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(begin));
  rest.insert(rest.end(), all.begin() + static_cast<std::ptrdiff_t>(end), all.end());
  return rest;
}

class Shrinker {
 public:
  Shrinker(const Campaign& campaign, std::int64_t number, const ShrinkOptions& options, const Simulation& simulation)
      : campaign_(campaign), options_(options), simulation_(simulation), case_values_(campaign.values_of(number)) {
    best_.number = number;
    best_.duration = campaign.scenario().duration;
  }

  Result<Shrunk> run();

 private:
  /// The result of an attempt.
  enum class Tried { fails, is_other, ended };

  const std::vector<Variation>& variations() const { return campaign_.scenario().variations; }
  Result<Tried> attempt(const std::vector<std::string>& values, double duration);
  Result<Tried> attempt(const Indices& differing);
  Result<bool> remove_and_bisect();
  Result<bool> remove_parameters();
  Result<bool> bisect(std::size_t index);
  double distance(std::size_t index) const;
  Result<bool> cut_duration();
  void keep_differing();

  const Campaign& campaign_;
  const ShrinkOptions& options_;
  const Simulation& simulation_;
  const std::vector<std::string> case_values_;
  CaseResult wanted_;             // the failure
  std::set<std::string> others_;  // scenarios that don't fail for the wanted reason
  Shrunk best_;
};

/// Runs the scenario with these values; if it fails for the wanted reason, it is the best so far.
Result<Shrinker::Tried> Shrinker::attempt(const std::vector<std::string>& values, double duration) {
  if (best_.runs >= options_.budget || interruption() != 0) return Tried::ended;
  const std::vector<std::string> linked = campaign_.with_links(values);
  auto text = campaign_.scenario().varied_text(linked);
  if (text && duration != campaign_.scenario().duration)
    text = text_with(*text, campaign_.scenario().file, "duration", fmt::format("{}", duration));
  if (!text) return text.errors();
  if (others_.contains(*text)) return Tried::is_other;
  const auto run = run_text(campaign_, *text, {}, simulation_);
  if (!run && interruption() != 0) return Tried::ended;
  if (!run) return run.errors();
  ++best_.runs;
  const CaseResult& result = run->result;
  if (best_.scenario.empty()) {
    wanted_ = result;
    best_.changed = run->changed;
  }
  const bool fails = !result.passed() && result.verdict == wanted_.verdict && result.reason == wanted_.reason;
  if (fails) {
    best_.result = result;
    best_.values = linked;
    best_.duration = duration;
    best_.scenario = *std::move(text);
    keep_differing();
  } else {
    others_.insert(*std::move(text));
  }
  if (options_.progress && !options_.progress(best_.runs, best_.differs.size())) return Tried::ended;
  return fails ? Tried::fails : Tried::is_other;
}

/// Tries a run in which the parameters with these indices have their best values so far, and all others are nominal.
Result<Shrinker::Tried> Shrinker::attempt(const Indices& differing) {
  std::vector<std::string> values(variations().size());
  for (const std::size_t i : differing) values[i] = best_.values[i];
  return attempt(values, best_.duration);
}

void Shrinker::keep_differing() {
  best_.differs.clear();
  for (std::size_t i = 0; i < variations().size(); ++i) {
    const auto value = number_in<double>(best_.values[i]), nominal = number_in<double>(variations()[i].nominal);
    const bool is_same = best_.values[i].empty() || best_.values[i] == variations()[i].nominal ||
                         (value && nominal && *value == *nominal);
    if (!is_same && variations()[i].distribution != Distribution::linked) best_.differs.push_back(i);
  }
}

/// Delta debugging; false: the search has ended.
Result<bool> Shrinker::remove_parameters() {
  Indices differing = best_.differs;
  for (std::size_t parts = 2; !differing.empty();) {
    parts = std::min(parts, differing.size());
    bool is_smaller = false;
    const std::size_t size = differing.size();
    for (std::size_t part = 0; part < parts && !is_smaller; ++part) {
      const std::size_t begin = size * part / parts, end = size * (part + 1) / parts;
      const Indices alone(differing.begin() + static_cast<std::ptrdiff_t>(begin),
                          differing.begin() + static_cast<std::ptrdiff_t>(end));
      for (const Indices& candidate : {alone, without(differing, begin, end)}) {
        if (candidate.size() == size || is_smaller) continue;
        const auto tried = REHEARSE_TRY(attempt(candidate));
        if (tried == Tried::ended) return false;
        if (tried == Tried::is_other) continue;
        parts = candidate.size() < size - (end - begin) ? 2 : std::max<std::size_t>(parts - 1, 2);
        differing = candidate;
        is_smaller = true;
      }
    }
    if (is_smaller) continue;
    if (parts == differing.size()) return true;
    parts *= 2;
  }
  return true;
}

/// Moves a number towards nominal as far as it fails.
Result<bool> Shrinker::bisect(std::size_t index) {
  const auto value = number_in<double>(best_.values[index]), nominal = number_in<double>(variations()[index].nominal);
  if (!value || !nominal) return true;
  double fails = 1.0, passes = 0.0;  // shares of the distance
  for (int i = 0; i < halvings; ++i) {
    const double share = 0.5 * (fails + passes);
    double number = *nominal + share * (*value - *nominal);
    number =
        variations()[index].integer ? std::round(number) : number_in<double>(fmt::format("{:.4g}", number)).value();
    std::vector<std::string> values = best_.values;
    values[index] = fmt::format("{}", number);
    if (values[index] == best_.values[index] || number == *nominal) break;
    const auto tried = REHEARSE_TRY(attempt(values, best_.duration));
    if (tried == Tried::ended) return false;
    (tried == Tried::fails ? fails : passes) = share;
  }
  return true;
}

/// From the nominal value; 0: one of the two is no number.
double Shrinker::distance(std::size_t index) const {
  const auto value = number_in<double>(best_.values[index]), nominal = number_in<double>(variations()[index].nominal);
  return value && nominal ? std::abs(*value - *nominal) : 0.0;
}

/// A parameter may become needless, or move further, after another one has moved; repeats both until nothing changes.
Result<bool> Shrinker::remove_and_bisect() {
  std::set<std::size_t> settled;  // bisected since the last change of any other parameter
  for (;;) {
    const std::size_t before = best_.differs.size();
    if (auto going_on = remove_parameters(); !going_on || !*going_on) return going_on;
    if (best_.differs.size() < before) settled.clear();
    const Indices differing = best_.differs;
    const auto next = std::ranges::find_if(differing, [&](std::size_t index) { return !settled.contains(index); });
    if (next == differing.end()) return true;
    const double far = distance(*next);
    if (auto going_on = bisect(*next); !going_on || !*going_on) return going_on;
    if (far - distance(*next) > least_move * far) settled.clear();
    settled.insert(*next);
  }
}

/// Cuts the duration, so that the run ends soon after the failure.
Result<bool> Shrinker::cut_duration() {
  if (!best_.result.tick) return true;
  const double step = campaign_.scenario().time_step;
  double passes = step * static_cast<double>(*best_.result.tick), fails = best_.duration;
  for (int i = 0; i < halvings && fails - passes > step; ++i) {
    const double tried_at = i == 0 ? passes + 2.0 * step : 0.5 * (passes + fails);
    const double duration = number_in<double>(fmt::format("{:.6g}", std::ceil(tried_at / step) * step)).value();
    if (duration >= fails) break;
    const auto tried = REHEARSE_TRY(attempt(best_.values, duration));
    if (tried == Tried::ended) return false;
    (tried == Tried::fails ? fails : passes) = duration;
    if (i == 0 && tried == Tried::fails) break;
  }
  return true;
}

Result<Shrunk> Shrinker::run() {
  const auto first = REHEARSE_TRY(attempt(case_values_, best_.duration));
  if (best_.scenario.empty() && interruption() != 0) return error("interrupted: nothing was shrunk");
  if (wanted_.passed())
    return error_in(campaign_.folder().string(), fmt::format("case {} passes", best_.number),
                    best_.changed.empty()
                        ? "expected a case that fails: rehearse sweep report lists some"
                        : fmt::format("the controller {} has changed since the campaign began", best_.changed.front()));
  Result<bool> going_on = first != Tried::ended;
  if (*going_on) going_on = remove_and_bisect();
  if (going_on && *going_on) going_on = cut_duration();
  if (!going_on) return going_on.errors();
  best_.finished = *going_on;
  return best_;
}

/// Rewrites the paths of a scenario, so that they name the same files from another folder.
Result<std::string> moved_text(const Scenario& scenario, std::string text, const fs::path& folder) {
  std::error_code failed;
  const fs::path from = fs::absolute(fs::path(scenario.file).parent_path(), failed);
  const fs::path to = fs::absolute(folder.empty() ? fs::path(".") : folder, failed);
  const auto moved = Scenario::load_text(text, scenario.file);  // a campaign may vary models
  if (!moved) return moved.errors();
  const auto move = [&](const std::string& place, const std::string& written) -> Result<void> {
    auto changed =
        REHEARSE_TRY(text_with(text, scenario.file, place, (from / written).lexically_relative(to).string()));
    text = std::move(changed);
    return {};
  };
  for (const ScenarioBody& body : moved->bodies) {
    const std::string place = "bodies." + body.name;
    if (!body.model_file.empty() && !fs::path(body.model_file).is_absolute())
      REHEARSE_TRY(move(place + ".model", body.model_file));
    for (const auto& [package, directory] : body.packages)
      if (!fs::path(directory).is_absolute()) REHEARSE_TRY(move(place + ".packages." + package, directory));
    for (const ScenarioController& controller : body.controllers)
      if (controller.library.find('/') != std::string::npos && !fs::path(controller.library).is_absolute())
        REHEARSE_TRY(move(place + ".controllers." + controller.name + ".library", controller.library));
  }
  return text;
}

std::string comment_of(const Campaign& campaign, const Shrunk& shrunk) {
  const std::vector<Variation>& variations = campaign.scenario().variations;
  std::string text =
      fmt::format("# Case {} of a campaign with {}, seed {}: {} of {} parameters differ.\n", shrunk.number,
                  campaign.scenario().name, campaign.options().seed, shrunk.differs.size(), variations.size());
  for (const std::size_t i : shrunk.differs)
    text += fmt::format("#   {}: {} instead of {} ({})\n", variations[i].name, shrunk.values[i], variations[i].nominal,
                        variations[i].path);
  std::string sentence = shrunk.result.sentence;
  std::ranges::replace(sentence, '\n', ' ');
  return text + "# " + sentence + "\n";
}

}  // namespace

Result<Shrunk> shrink(const Campaign& campaign, std::int64_t number, const ShrinkOptions& options,
                      const Simulation& simulation) {
  REHEARSE_TRY(campaign.check_number(number));
  return Shrinker(campaign, number, options, simulation).run();
}

Result<void> write_shrunk(const Campaign& campaign, const Shrunk& shrunk, const fs::path& file,
                          const Simulation& simulation) {
  auto text = moved_text(campaign.scenario(), shrunk.scenario, file.parent_path());
  for (const char* key : {"vary", "golden", "plan", "pass_rate", "sometimes"})
    if (text) text = text_without(*text, campaign.scenario().file, key);
  if (!text) return text.errors();
  *text = comment_of(campaign, shrunk) + *text;
  REHEARSE_TRY(replace_text(file, *text));
  if (!simulation.record) return {};
  const auto again =
      REHEARSE_TRY(run_alone(campaign, *text, file, fs::path(file).replace_extension(".mcap"), simulation));
  if (again.result.verdict == shrunk.result.verdict && again.result.reason == shrunk.result.reason) return {};
  return error_in(file.string(),
                  fmt::format("the written scenario ends differently: {}: {}", to_string(again.result.verdict),
                              again.result.sentence),
                  "does a controller read files beside the scenario? name a file there with -o");
}

}  // namespace rehearse
