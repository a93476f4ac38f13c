// Accepting a part of a run: makes the candidate, and tests whether some run can produce it.
#include <fmt/format.h>
#include <rehearse/golden.h>
#include <rehearse/mcap.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <algorithm>

#include "base/names.h"
#include "core/compare/divergence_text.h"
#include "core/host/controller_host.h"
#include "core/recording/provenance.h"
#include "core/replay/plant_level.h"
#include "core/scenario/trace_scenario.h"
#include "golden_files.h"
#include "partial_candidate.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t companions_named = 6;

Diagnostic refusal(const std::string& where, const PartialCandidate& candidate) {
  const std::vector<std::string>& kept = candidate.moved_but_kept();
  return error("no run can produce this golden: " + where,
               kept.empty() ? "accept all of the run"
                            : fmt::format("these moved too, and would have to be accepted as well: {}",
                                          listed(kept, companions_named)));
}

/// The recording's scenario, or, if it needs meshes, its scenario file.
Result<Scenario> scenario_to_run(const Trace& recording, const std::vector<fs::path>& files) {
  auto own = recorded_scenario(recording);
  if (!own) return own;
  const bool has_meshes = std::ranges::any_of(
      recording.attachments(), [](const mcap::Attachment& attachment) { return attachment.name.ends_with(".meshes"); });
  if (!has_meshes) return own;
  const mcap::Attachment* text = recording.find_attachment("scenario.yaml");
  for (const fs::path& file : files) {
    const auto content = read_text(file);
    if (!content || *content != text->text()) continue;
    auto scenario = Scenario::load(file);
    if (!scenario) return scenario;
    scenario->seed = own->seed;  // the command line may have set it
    scenario->duration = own->duration;
    return scenario;
  }
  return error("no scenario file equals this run's scenario, and its meshes are needed to run it again",
               "accept all of the run, or record it again");
}

/// The libraries that execute the candidate; they may differ from the run's, and become the candidate's.
Result<mcap::StringMap> controllers_of(const Trace& run, const HostOptions& options) {
  const auto scenario = REHEARSE_TRY(recorded_scenario(run));
  const auto host = REHEARSE_TRY(ControllerHost::create(scenario, options));
  return controller_facts(*host);
}

/// The first difference on the plant level, bit for bit.
Result<std::optional<Divergence>> first_of_plant(const fs::path& candidate, const Reexecution& again) {
  const auto recording = REHEARSE_TRY(Trace::load(candidate));
  const auto scenario = REHEARSE_TRY(scenario_to_run(recording, again.scenarios));
  const fs::path file = candidate.string() + ".plant";
  const auto level = compare_plant({nullptr, again.run_plant}, scenario, recording, file, {});
  std::error_code ignored;
  fs::remove(file, ignored);
  if (!level) return level.errors();
  if (level->run.failure) return *level->run.failure;
  return level->comparison.first_bit;
}

/// The first place where the candidate doesn't follow from itself when it is executed again; nullopt if there is no
/// such place.
Result<std::optional<std::string>> first_break(const fs::path& candidate, const Reexecution& again) {
  if (!again.run_plant)
    return std::optional<std::string>(
        "the kept part differs from this run, and without physics nothing shows that it fits the accepted part");
  ReplayOptions options;
  static_cast<HostOptions&>(options) = again.host;
  const auto commands = REHEARSE_TRY(again.replay ? again.replay(candidate, options) : replay(candidate, options));
  const auto plant = REHEARSE_TRY(first_of_plant(candidate, again));
  if (commands.failure) return std::optional<std::string>(commands.failure->message);
  if (commands.first && !(plant && comes_before(*plant, *commands.first)))
    return std::optional("with its inputs, the controllers give other commands, first at " +
                         to_string(*commands.first));
  if (plant) return std::optional("with its commands, the world moves differently, first at " + to_string(*plant));
  return std::optional<std::string>();
}

}  // namespace

std::string to_string(const Selection& selection) {
  std::string text;
  if (!selection.channels.empty())
    text = (selection.channels.size() == 1 ? "channel " : "channels ") + listed(selection.channels, 8);
  if (selection.from > 0.0) text += fmt::format("{}from {} s", text.empty() ? "" : ", ", selection.from);
  if (selection.until) text += fmt::format("{}until {} s", text.empty() ? "" : ", ", *selection.until);
  return text;
}

Result<fs::path> make_partial(const Trace& golden, const Trace& run, const Selection& selection,
                              const fs::path& candidate_file, const Reexecution& again) {
  auto candidate = REHEARSE_TRY(PartialCandidate::make(golden, run, selection));
  if (!candidate.anything_moves())
    return error(fmt::format("nothing of {} differs from the golden", to_string(selection)),
                 candidate.is_the_run() ? "nothing else differs either"
                                        : "different: " + listed(candidate.moved_but_kept(), companions_named));
  if (candidate.is_the_run()) return fs::path(run.file());
  if (const auto& start = candidate.other_start()) return refusal(*start, candidate);

  const auto controllers = REHEARSE_TRY(controllers_of(run, again.host));
  REHEARSE_TRY(candidate.write(run, controllers, candidate_file));
  const auto broken = first_break(candidate_file, again);
  std::optional<Diagnostics> refused;
  if (!broken)
    refused = broken.errors();
  else if (*broken)
    refused = Diagnostics{refusal(**broken, candidate)};
  else if (const auto& mixed = candidate.mixed())
    refused = Diagnostics{refusal(*mixed, candidate)};
  if (!refused) return candidate_file;
  std::error_code ignored;
  fs::remove(candidate_file, ignored);
  return *refused;
}

}  // namespace rehearse
