#include "blame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "changed_files.h"
#include "check_run.h"
#include "core/compare/divergence_text.h"
#include "core/guard/own_process.h"
#include "core/kinds/channel_name.h"
#include "core/replay/plant_level.h"
#include "core/scenario/structure_change.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "other_physics.h"
#include "other_processor.h"
#include "own_run.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The first tick in which two replays of the recording have different outputs; none: they have equal bits in all
/// ticks. Fails if the recording can't be replayed.
Result<std::optional<std::int64_t>> first_unrepeated_tick(const fs::path& recording, const HostOptions& host) {
  const auto once = REHEARSE_TRY(replayed_outputs(recording, as_here(host)));
  const auto again = REHEARSE_TRY(replayed_outputs(recording, as_here(host)));
  if (once == again) return std::optional<std::int64_t>();
  return std::optional(std::ranges::mismatch(once, again).in1 - once.begin());
}

/// Repeats level plant, up to the beginning of the tick `options.until`. None: the run failed.
std::optional<Comparison> plant_again(const Suspects& with, const Scenario& scenario, const PlantOptions& options) {
  auto again = compare_plant(with.simulation, scenario, with.golden, with.scratch, options);
  std::error_code ignored;
  fs::remove(with.scratch, ignored);
  if (!again) return std::nullopt;
  return std::move(again->comparison);
}

/// The changed files that the controllers read beside their inputs, for a verdict; empty if there are none.
std::string files_text(const ReplayReport& replayed) {
  return replayed.changed_files.empty() ? "" : fmt::format("; {}", fmt::join(replayed.changed_files, "; "));
}

/// How the controllers' variables relate to the recorded ones, for a verdict; empty if nothing is known.
std::string relations_of(const ReplayReport& replayed) {
  return replayed.explanation.empty() ? "" : "; " + replayed.explanation;
}

/// The first line or variable that the controllers wrote otherwise before their first different command; empty: none.
std::string earlier_words(const ReplayReport& replayed, const Divergence& first) {
  const std::optional<Divergence>& word = replayed.words.first;
  if (!word || word->tick >= first.tick) return "";
  return fmt::format("at tick {} ({:g} s), before its commands differ, {}; ", word->tick, word->time,
                     word->channel == run_topics::events ? word->note : to_string(*word));
}

/// True if the closed loop has the golden's commands and results of control().
bool repeats_in_the_loop(const CheckReport& evidence) {
  if (!evidence.comparison || !evidence.run || evidence.run->ending()) return false;
  return std::ranges::none_of(evidence.comparison->channels, [](const ChannelComparison& channel) {
    const bool of_results = channel.of_events && channel.channel == run_topics::tick;
    return channel.first_bit && (of_results || ChannelName::parse(channel.channel).side == ChannelSide::output);
  });
}

/// The verdict for a controller that doesn't repeat its own commands: then its library may be new, but isn't to blame
/// for the difference. None: nothing shows that.
std::optional<Blame> unsteady_controller(const Suspects& with, const Divergence& first, const CheckReport& evidence) {
  const auto unrepeated = first_unrepeated_tick(with.golden.file(), with.host);
  if (unrepeated && *unrepeated)
    return Blame{
        {VerdictCode::controller_unsteady,
         fmt::format("the controller depends on something besides its recorded inputs: {}two replays of the golden "
                     "differ from each other at tick {}; fed with the golden's inputs, it differs at {}; it depends on "
                     "uninitialised memory, the clock, earlier runs or chance; `rehearse audit` finds the "
                     "cause",
                     evidence.replay->same_controllers ? "it is the recorded one, but " : "", **unrepeated,
                     to_string(first))},
        first};
  if (!repeats_in_the_loop(evidence)) return std::nullopt;
  return Blame{
      {VerdictCode::controller_unsteady,
       fmt::format(
           "{}the controller depends on something besides its recorded inputs: in the closed loop it gave the golden's "
           "commands, but fed with the golden's inputs {}, it differs at {}; `rehearse audit` finds the cause",
           begin_without_guests() ? "" : "an earlier run left data behind, or ",
           has_own_processes() ? "in a process of its own" : "later in the same process", to_string(first))},
      first};
}

/// "; the run leaves its own: Arm/SHOULDER/q is beyond ...", for a controller whose commands are within tolerance;
/// empty if no run was compared.
std::string effect_on_run(const CheckReport& evidence) {
  if (!evidence.comparison) return {};
  if (evidence.comparison->within) return "; the run stays within its tolerances";
  const Divergence& first = *evidence.comparison->first;
  return "; " +
         headline_of(
             first, worst_of_channel(*evidence.comparison, first),
             {.when = when_text(first), .before_beyond = "the run leaves its own: ", .before_differs = "the run "});
}

/// The difference of the commands, measured on the golden's inputs, and its effect on the run.
std::string commands_text(const CheckReport& evidence) {
  const ReplayReport& replayed = *evidence.replay;
  return headline(replayed, "fed with the golden's inputs, ", "fed with the golden's inputs, it ") +
         (replayed.beyond ? "" : effect_on_run(evidence));
}

/// The verdict for a controller whose library is the recorded one, but whose commands differ.
Blame same_controller(const Divergence& first, const CheckReport& evidence) {
  const std::vector<std::string>& files = evidence.replay->changed_files;
  const std::string cause = files.empty() ? "something beside the controller's inputs has changed since the recording"
                                          : fmt::format("{}", fmt::join(files, "; "));
  return {{VerdictCode::controller_surroundings_changed,
           fmt::format("{}: the controller is the recorded one, and two replays agree with each other, but {}{}", cause,
                       commands_text(evidence),
                       files.empty() ? "; `rehearse audit` reports whether it depends on files, variables or "
                                       "uninitialised memory"
                                     : "")},
          first,
          evidence.replay->first};
}

Blame blame_controller(const Suspects& with, const CheckReport& evidence) {
  if (!evidence.replay)
    return {{VerdictCode::controller_not_fed,
             "the controllers can't be fed with the golden's inputs: " + evidence.controller_problem},
            std::nullopt};
  if (!evidence.replay->first)
    return {{VerdictCode::controller_changed, "the controller changed: fed with the golden's inputs, " +
                                                  evidence.replay->failure->message + files_text(*evidence.replay)},
            std::nullopt};
  const Divergence& first = evidence.replay->beyond ? *evidence.replay->beyond : *evidence.replay->first;
  if (first.stage == Stage::inputs)
    return {{VerdictCode::golden_altered, "the golden differs from the run that was recorded: at " + to_string(first)},
            first};
  if (auto unsteady = unsteady_controller(with, first, evidence)) return *std::move(unsteady);
  if (evidence.replay->same_controllers) return same_controller(first, evidence);
  return {{VerdictCode::controller_changed, "the controller changed: " + earlier_words(*evidence.replay, first) +
                                                commands_text(evidence) + relations_of(*evidence.replay) +
                                                files_text(*evidence.replay)},
          first,
          evidence.replay->first};
}

/// The first difference of the state before `place`, if it shows that the physics changed; null: there is none.
/// Measurements of sensors and cameras follow from the state, and may leave their tolerances before the state does.
/// With equal arithmetic, different bits in the state show a change of the physics. After the last sample of a golden
/// that contains samples, the hash of the state shows it, which also depends on the seed.
const Divergence* state_before(const Divergence& place, const Comparison& comparison, const Trace& golden) {
  if (place.stage == Stage::physics) return nullptr;
  const auto samples = RunFacts::of(golden).state_rate;
  const Divergence* before = nullptr;
  for (const ChannelComparison& channel : comparison.channels) {
    if (!channel.first_bit || channel.first_bit->stage != Stage::physics) continue;
    const bool is_hash = channel.channel == run_topics::tick;
    if (is_hash && (!samples || channel.first_bit->tick <= samples->last_sample(place.tick))) continue;
    const Divergence& bit = *channel.first_bit;
    const bool notable = comparison.same_arithmetic ||
                         (channel.worst && times_tolerance(channel.worst->judged(), channel.worst->tolerance) > 1e-3);
    if (notable && bit.tick <= place.tick && (!before || bit.tick < before->tick)) before = &bit;
  }
  return before;
}

/// True if the world agrees with the golden under the noise of the recorded scenario, instead of this one's.
bool is_noise(const Suspects& with, const Divergence& place, const Scenario& recorded) {
  const auto noisy = [](const Scenario& scenario) {
    return std::ranges::any_of(scenario.bodies, [](const ScenarioBody& body) {
      return !body.errors.devices.empty() || !body.errors.joints.empty();
    });
  };
  const bool same_bodies = recorded.bodies.size() == with.scenario.bodies.size();
  if (!same_bodies || (!noisy(with.scenario) && !noisy(recorded))) return false;
  PlantOptions options;
  options.until = place.tick;
  options.noise_of = &recorded;
  const auto again = plant_again(with, with.scenario, options);
  return again && again->within;
}

/// True for a mesh that a recording doesn't contain: heightmaps are attached to it.
bool is_mesh(const Shape& shape) {
  const auto* mesh = std::get_if<Mesh>(&shape.geometry);
  return mesh && !mesh->heightmap;
}

/// The cause of a difference of the plant, for a verdict.
struct Cause {
  std::vector<VerdictCode> codes;
  std::string subject;  // of "changed"; empty: only the stage is known
  std::string reason;   // the rest of the sentence
};

/// One statement with several codes.
Verdict verdict_of(const std::vector<VerdictCode>& codes, std::string sentence) {
  Verdict verdict;
  for (const VerdictCode code : codes) verdict.add(code, std::exchange(sentence, {}));
  return verdict;
}

VerdictCode code_of(Stage stage) {
  switch (stage) {
    case Stage::sensors: return VerdictCode::sensors_changed;
    case Stage::renderer: return VerdictCode::renderer_changed;
    case Stage::controller: return VerdictCode::controller_changed;
    case Stage::inputs: return VerdictCode::controller_inputs_changed;
    case Stage::costs: return VerdictCode::costs_changed;
    case Stage::physics: break;
  }
  return VerdictCode::physics_changed;
}

Cause cause_of(const Suspects& with, const Divergence& place, const Comparison& comparison) {
  const ChangedFiles changed = changed_files(with.scenario, with.golden, comparison.changed_files, true);
  const std::string& files = changed.text;
  const auto recorded = recorded_scenario(with.golden);
  const std::string also_changed = files.empty() ? "" : fmt::format("; changed since it was recorded: {}", files);
  const std::vector<VerdictCode> stage{code_of(place.stage)};
  if (!recorded) return {stage, "", also_changed};
  if (place.stage != Stage::physics && is_noise(with, place, *recorded)) {
    const auto stated = RunFacts::of(with.golden).seed;
    const std::string seed = stated ? std::to_string(*stated) : "?";
    if (seed == std::to_string(with.scenario.seed))
      return {{VerdictCode::noise_changed}, "the noise", "; with the golden's noise, the world agrees"};
    return {{VerdictCode::noise_changed},
            "the random stream of the noise",
            fmt::format("; with the golden's seed {} instead of {}, the world agrees", seed, with.scenario.seed)};
  }
  if (files.empty()) return {stage, "", "; scenario and models are what they were: the simulation itself changed"};
  const bool has_meshes = std::ranges::any_of(recorded->bodies, [](const ScenarioBody& body) {
    return std::ranges::any_of(body.model->links,
                               [](const Link& link) { return std::ranges::any_of(link.collisions, is_mesh); });
  });
  if (has_meshes) return {stage, "", also_changed};
  PlantOptions options;
  options.until = place.tick;
  const auto again = plant_again(with, *recorded, options);
  if (!again) return {stage, "", also_changed};
  if (again->within) return {changed.codes, files, "; with the recorded version, the world agrees"};
  return {stage, "", fmt::format("; {} changed, too, but with the recorded version the world also differs", files)};
}

Blame blame_plant(const Suspects& with, const CheckReport& evidence) {
  if (!evidence.plant_comparison)
    return {
        {VerdictCode::world_not_moved, "the world can't be moved by the golden's commands: " + evidence.plant_problem},
        std::nullopt};
  const Comparison& comparison = *evidence.plant_comparison;
  Divergence place = *comparison.first;
  const bool is_whole = evidence.plant_run.has_value();  // else the worst may follow
  const std::string news = headline_of(place, is_whole ? worst_of_channel(comparison, place) : std::nullopt,
                                       {.when = when_text(place), .before_differs = "the world "});
  std::string since;
  if (const Divergence* before = state_before(place, comparison, with.golden)) {
    since = fmt::format("; before that, the last bits of {} {} differ from tick {} on", before->channel,
                        before->element, before->tick);
    place.stage = Stage::physics;
  }
  if (const std::string rounding = rounding_text(comparison); !rounding.empty())
    return {{code_of(place.stage), "under the golden's commands, " + rounding}, place};
  const bool innocent = evidence.controller == LevelState::equal && evidence.replay && evidence.replay->values > 0;
  const Cause cause = cause_of(with, place, comparison);
  return {verdict_of(cause.codes, fmt::format("{} changed{}: under the golden's commands, {}{}{}",
                                              cause.subject.empty() ? to_string(place.stage) : cause.subject,
                                              innocent ? ", the controller did not" : "", news, since, cause.reason)),
          place, since.empty() ? comparison.first_bit : std::nullopt};
}

/// The verdict if no part differs alone, but the closed loop does.
Blame blame_loop(const Suspects& with, const CheckReport& evidence) {
  const Comparison& comparison = *evidence.comparison;
  const Divergence& first = *comparison.first;
  if (const std::string rounding = rounding_text(comparison); !rounding.empty())
    return {{VerdictCode::run_changed, rounding}, first};
  const bool is_within = evidence.controller == LevelState::within;
  const bool both_known =
      (is_within || evidence.controller == LevelState::equal) && evidence.plant != LevelState::not_compared;
  if (!both_known) return {{VerdictCode::run_changed, verdict(comparison)}, first};
  const Divergence& bit = *comparison.first_bit;
  const bool follows_state = state_before(first, comparison, with.golden) != nullptr;
  if (bit.stage == Stage::inputs || (first.stage == Stage::inputs && !follows_state))
    return {{VerdictCode::controller_inputs_changed,
             "the controller got other inputs than in the golden: the run " + verdict(comparison)},
            first};
  if (is_within || evidence.plant == LevelState::within)
    return {
        {VerdictCode::loop_amplified,
         "no part changed beyond its tolerance, but the loop amplifies small changes: the run " + verdict(comparison)},
        first};
  Divergence place = first;  // the world follows its commands: if it differs, they differed
  place.stage = Stage::controller;
  if (const ChangedFiles changed = changed_files(with.scenario, with.golden, comparison.changed_files, false);
      !changed.text.empty())
    return {verdict_of(changed.codes,
                       fmt::format("the controller depends on a change in {}: with the golden's version, it repeats "
                                   "its recorded commands, with the present one it doesn't; the run {}",
                                   changed.text, verdict(comparison))),
            place};
  const auto unrepeated = first_unrepeated_tick(with.actual, with.host);
  if (unrepeated && *unrepeated)
    return {
        {VerdictCode::controller_unsteady,
         fmt::format("the controller depends on something besides its recorded inputs: two replays of this run differ "
                     "from each other at tick {}; the run {}; `rehearse audit` finds the cause",
                     **unrepeated, verdict(comparison))},
        place};
  return {
      {VerdictCode::run_changed,
       "the controller repeats the golden's commands and the world follows them, but the run " + verdict(comparison)},
      first};
}

std::string nothing_differs(const Suspects& with, const CheckReport& report) {
  if (report.comparison) return verdict(*report.comparison, report.horizon);
  std::string sentence;
  if (report.controller != LevelState::not_compared)
    sentence =
        fmt::format("the controller repeats {} recorded ticks {}", report.replay->ticks,
                    report.replay->equal()                       ? "bit for bit"
                    : computes_alike(with.scenario, with.golden) ? "within tolerance"
                                                                 : "within tolerance, with different arithmetic");
  if (report.plant == LevelState::not_compared) return sentence;
  if (report.plant == LevelState::proved) return sentence + "; the world is the one that made the golden";
  return fmt::format("{}{}the world under the recorded commands: {}", sentence, sentence.empty() ? "" : "; ",
                     verdict(*report.plant_comparison));
}

/// The verdict if only the costs of control() differ, which come after all other differences; none: others do.
std::optional<Blame> changed_costs(const CheckReport& report) {
  if (!report.comparison || !report.comparison->first || report.comparison->first->stage != Stage::costs)
    return std::nullopt;
  if (report.controller == LevelState::differs || report.plant == LevelState::differs) return std::nullopt;
  const Divergence& place = *report.comparison->first;
  const ChannelName name = ChannelName::parse(place.channel);
  return Blame{
      {VerdictCode::costs_changed,
       fmt::format("the costs of control() of {}/{} changed, its commands did not: {}; "
                   "`rehearse audit --realtime` names the lines",
                   name.body, name.owner,
                   headline_of(place, worst_of_channel(*report.comparison, place), {.when = when_text(place)}))},
      place,
      report.comparison->first_bit};
}

/// The part of the loop that differs, if the scenario is the recorded one.
Blame guilty_part(const Suspects& suspects, const CheckReport& report) {
  const bool controller_differs = report.controller == LevelState::differs;
  const bool plant_differs = report.plant == LevelState::differs;
  if (controller_differs && plant_differs) {
    const Blame controller = blame_controller(suspects, report), plant = blame_plant(suspects, report);
    Verdict both = controller.verdict;
    both.add(plant.verdict);
    const bool plant_first = plant.place && (!controller.place || comes_before(*plant.place, *controller.place));
    return {std::move(both), plant_first ? plant.place : controller.place, plant_first ? plant.bit : controller.bit};
  }
  if (controller_differs) {
    Blame controller = blame_controller(suspects, report);
    if (!report.other_physics.empty()) controller.verdict.add(verdict_on_physics(report, ""));
    return controller;
  }
  if (!report.other_physics.empty())
    return {verdict_on_physics(report, nothing_differs(suspects, report)), std::nullopt};
  if (plant_differs) return blame_plant(suspects, report);
  if (report.closed == LevelState::differs) {
    Blame loop = blame_loop(suspects, report);
    loop.bit = report.comparison->first_bit;
    return loop;
  }
  std::optional<Divergence> bit;
  if (report.comparison) bit = report.comparison->first_bit;
  if (!bit && report.plant_comparison) bit = report.plant_comparison->first_bit;
  const std::array levels{report.controller, report.plant, report.closed};
  const bool is_equal = std::ranges::count(levels, LevelState::within) == 0;
  return {{is_equal ? VerdictCode::same : VerdictCode::within_tolerance, nothing_differs(suspects, report)}, bit};
}

/// The same, in words that are true on this processor.
Blame guilty_part_here(const Suspects& suspects, const CheckReport& report) {
  if (auto costs = changed_costs(report)) return *std::move(costs);
  return on_this_processor(guilty_part(suspects, report), report,
                           Architectures::of(suspects.scenario, suspects.golden));
}

}  // namespace

void compare_other_levels(const Suspects& with, CheckReport& report) {
  const bool closed_differs = report.closed == LevelState::differs && report.comparison->first->stage != Stage::costs;
  if (!closed_differs && report.other_physics.empty()) return;
  if (report.controller == LevelState::not_compared) {
    if (auto replayed = replay_golden(with.scenario, with.golden, with.host)) {
      report.controller = replayed->state;
      report.replay = std::move(replayed->replay);
    }
  }
  if (closed_differs && report.plant == LevelState::not_compared) {
    PlantOptions options;
    options.until = report.comparison->first->tick;
    report.plant_comparison = plant_again(with, with.scenario, options);
    if (!report.plant_comparison) return;
    report.plant = report.plant_comparison->within ? LevelState::within : LevelState::differs;
    report.plant_until = options.until;
  }
}

/// Parts of a scenario with other bodies, joints or controllers can't be compared alone, so its change comes first.
Blame find_guilty(const Suspects& suspects, const CheckReport& report) {
  Blame found = guilty_part_here(suspects, report);
  const mcap::Attachment* recorded = suspects.golden.find_attachment("scenario.yaml");
  if (!recorded || !any_level_differs(report)) return found;
  std::string change = structure_change(std::string(recorded->text()), suspects.scenario.text);
  const bool is_of_scenario = !change.empty();
  if (is_of_scenario) {
    change = "the scenario changed: " + change;
  } else {
    const auto earlier = recorded_scenario(suspects.golden);
    if (earlier) change = model_change(*earlier, suspects.scenario);
    if (change.empty()) return found;
  }
  if (const auto& comparison = report.comparison)
    change += comparison->within
                  ? "; the run " + verdict(*comparison)
                  : "; " + headline_of(*comparison->first, worst_of_channel(*comparison, *comparison->first),
                                       {.when = when_text(*comparison->first),
                                        .before_beyond = "the run differs: ",
                                        .before_differs = "the run "});
  found.verdict = {is_of_scenario ? VerdictCode::scenario_changed : VerdictCode::model_changed, std::move(change)};
  found.bit.reset();
  found.is_of_structure = true;
  return found;
}

}  // namespace rehearse
