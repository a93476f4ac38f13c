// replay FLIGHT --scenario FILE: a scenario in which the robot begins as in the flight.
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "log_verbs.h"
#include "model_scenario.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

/// The displacements in the first message with all joints; those that the loop doesn't read are at rest.
Result<std::vector<double>> first_posture(mcap::Reader& flight, const std::string& body, const Model& model) {
  std::vector<double> posture = rest_posture(model);
  const std::string topic = ChannelName::of_body(body, ChannelKind::joints).topic();
  for (const auto& [id, channel] : flight.channels()) {
    if (channel.topic != topic) continue;
    mcap::OrderedMessages messages(flight, std::span(&id, 1));
    const mcap::Message* const first = messages.next();
    REHEARSE_TRY(messages.verdict());
    msg::JointState state;
    CdrReader bytes(first ? first->data : mcap::Bytes());
    if (!first || !msg::decode(bytes, state)) continue;
    for (std::size_t i = 0; i < state.name.size() && i < state.position.size(); ++i) {
      const auto link = model.find_joint(state.name[i]);
      if (link < 0 || !std::isfinite(state.position[i])) continue;
      posture[static_cast<std::size_t>(model.links[static_cast<std::size_t>(link)].joint.id)] = state.position[i];
    }
  }
  return posture;
}

}  // namespace

Result<void> save_scenario_of_flight(const fs::path& file, const std::string& library, const std::string& scenario) {
  auto flight = REHEARSE_TRY(mcap::Reader::open(file));
  const Scenario flown = REHEARSE_TRY(scenario_of(*flight));
  const ScenarioBody& body = flown.bodies[0];
  const RunFacts facts = RunFacts::of(*flight);
  const auto ticks = facts.outcome ? facts.outcome->ticks : std::nullopt;
  const double duration = ticks ? static_cast<double>(*ticks) * flown.time_step : flown.duration;
  // The model stands beside the scenario, unless it does already.
  std::error_code ignored;
  const fs::path model = fs::path(scenario).parent_path() / fs::path(body.model_file).filename();
  if (!fs::exists(model, ignored)) REHEARSE_TRY(write_text(model, body.model->source_text));
  LogStart begin;
  begin.joints = REHEARSE_TRY(first_posture(*flight, body.name, *body.model));
  const RunOfALog run{file.string(), body.name, std::move(begin), flown.time_step,
                      MappedController{body.controllers[0].name, {}, false}};
  return save_scenario({model.string(), {library}, duration, run}, scenario);
}

}  // namespace rehearse::tool
