#include "scenario_changes.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "base/clock.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

Divergence change_of(const char* key, double recorded, double stated) {
  Divergence change;
  change.channel = "scenario";
  change.element = key;
  put_numbers(change, recorded, stated, "s");
  change.stage = Stage::inputs;
  return change;
}

std::set<std::string> controllers_of(const Scenario& scenario) {
  std::set<std::string> labels;
  for (const ScenarioBody& body : scenario.bodies) {
    for (const ScenarioController& controller : body.controllers) {
      labels.insert(body.name + "/" + controller.name);
      for (const ScenarioController& child : controller.children) labels.insert(body.name + "/" + child.name);
    }
  }
  return labels;
}

std::set<std::string> controllers_of(const Trace& recording) {
  std::set<std::string> labels;
  for (const auto& [label, library] : RunFacts::of(recording).controllers) labels.insert(label);
  return labels;
}

}  // namespace

std::optional<Divergence> changed_time_step(const Scenario& scenario, const Trace& recording) {
  const auto recorded = RunFacts::of(recording).time_step;
  if (!recorded || *recorded == scenario.time_step) return std::nullopt;
  return change_of("time_step", *recorded, scenario.time_step);
}

std::optional<Divergence> changed_duration(const Scenario& scenario, const Trace& recording) {
  const auto recorded = RunFacts::of(recording).duration;
  const auto ticks_of = [&](double duration) { return std::llround(duration / scenario.time_step); };
  if (!recorded || ticks_of(*recorded) == scenario.ticks()) return std::nullopt;
  Divergence change = change_of("duration", *recorded, scenario.duration);
  change.tick = std::min<std::int64_t>(ticks_of(*recorded), scenario.ticks()) - 1;
  change.time = time_of(change.tick, scenario.time_step);
  return change;
}

std::string changed_controllers(const Scenario& scenario, const Trace& recording) {
  const std::set<std::string> now = controllers_of(scenario), then = controllers_of(recording);
  for (const std::string& label : then)
    if (now.count(label) == 0)
      return fmt::format("{} has no controller '{}', but the golden has it", scenario.name, label);
  for (const std::string& label : now)
    if (then.count(label) == 0)
      return fmt::format("{} has a controller '{}' that the golden doesn't have", scenario.name, label);
  return "";
}

}  // namespace rehearse
