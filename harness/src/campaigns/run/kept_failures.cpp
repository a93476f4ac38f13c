// The failures that a project keeps, run again before its campaigns.
#include <rehearse/sweep.h>

#include <set>
#include <string>

#include "case_run.h"
#include "core/scenario/project.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

/// The options for one scenario of a project: a campaign's libraries are for its controllers alone, its golden for
/// none.
CampaignOptions options_for(const Scenario& scenario, CampaignOptions options) {
  std::set<std::string> controllers;
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers)
      controllers.insert({controller.name, body.name + '/' + controller.name});
  std::erase_if(options.host.libraries, [&](const auto& library) { return !controllers.contains(library.first); });
  options.golden.clear();
  return options;
}

}  // namespace

Result<std::vector<KeptFailure>> run_kept_failures(const Campaign& campaign, const Simulation& simulation) {
  std::vector<KeptFailure> made;
  const auto project = find_project(campaign.scenario().file);
  if (!project) return made;
  for (const fs::path& file : failure_files(*project)) {
    std::error_code ignored;
    KeptFailure failure{fs::proximate(file, ignored), {}};
    const auto scenario = Scenario::load(file);
    if (!scenario) {
      failure.result = ended_case(-1, CaseVerdict::invalid, scenario.errors().front().message);
      made.push_back(std::move(failure));
      continue;
    }
    auto run = REHEARSE_TRY(
        run_alone(campaign.folder(), options_for(*scenario, campaign.options()), scenario->text, file, {}, simulation));
    failure.result = std::move(run.result);
    made.push_back(std::move(failure));
  }
  return made;
}

}  // namespace rehearse
