#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/model.h>
#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/kinds/kinds.h"
#include "core/recording/mathematics.h"
#include "core/recording/provenance.h"
#include "core/trace/run_facts.h"
#include "flight_writer.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr double stated_duration = 86400.0;  // of a flight whose length isn't known [s]

std::string scenario_text(const TapRing& ring, const std::string& name, const std::string& body, double duration) {
  YAML::Emitter yaml;
  const auto text = [&yaml](const char* key, const std::string& value) {
    yaml << YAML::Key << key << YAML::Value << YAML::DoubleQuoted << value;
  };
  const auto number = [&yaml](const char* key, double value) {
    yaml << YAML::Key << key << YAML::Value << fmt::format("{}", value);
  };
  yaml << YAML::Comment("What the tap " + name + " recorded in a robot's loop. Its length is not stated here.");
  yaml << YAML::BeginMap << YAML::Key << "rehearse" << YAML::Value << 1;
  text("name", name);
  number("duration", duration);
  number("time_step", ring.time_step());
  yaml << YAML::Key << "bodies" << YAML::Value << YAML::BeginSeq << YAML::BeginMap;
  text("name", body);
  text("model", ring.model().filename().string());
  yaml << YAML::Key << "controllers" << YAML::Value << YAML::BeginSeq << YAML::BeginMap;
  text("name", ring.controller());
  text("library", ring.controller());
  yaml << YAML::Key << "delay" << YAML::Value << false;
  yaml << YAML::EndMap << YAML::EndSeq << YAML::EndMap << YAML::EndSeq;
  yaml << YAML::Key << "cameras" << YAML::Value << YAML::Flow << YAML::BeginSeq << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

/// Of a flight without a model: a body that has its name alone.
Scenario bare_scenario(const TapRing& ring, const std::string& name, const std::string& body, double duration) {
  Scenario bare;
  bare.name = name;
  bare.time_step = ring.time_step();
  bare.duration = duration;
  bare.bodies.emplace_back().name = body;
  bare.bodies[0].model = std::make_shared<Model>();
  return bare;
}

Result<Scenario> make_scenario(const TapRing& ring, const std::string& name, const std::string& body, double duration) {
  if (ring.model().empty()) return bare_scenario(ring, name, body, duration);
  UrdfOptions options;
  options.meshes = UrdfOptions::Meshes::skip;
  auto model = REHEARSE_TRY(load_model(ring.model(), options));
  return Scenario::parse(scenario_text(ring, name, body, duration), "scenario.yaml",
                         [&](const std::string&, const UrdfOptions&) -> Result<Model> { return model; });
}

/// The facts of the recording. The process of the loop isn't pinned: its mathematics is that of its machine.
mcap::StringMap provenance_of(const FlightPlan& plan, const TapRing& ring) {
  mcap::StringMap stated = provenance(plan.scenario, nullptr, "", "");
  for (const char* of_simulations :
       {facts::seed, facts::solver, facts::physics, facts::programs, facts::virtualised, facts::pinned_renderer})
    stated.erase(of_simulations);
  stated[facts::source] = "flight";
  stated[facts::flight] = fmt::format("{}.{}.{}", ring.realtime(), ring.monotonic(), ring.process());
  stated[facts::pinned] = "no: a robot's loop";
  stated[facts::pinned_mathematics] = rehearse::stated(plan.definitions.machine, flight_facts::tunables);
  return stated;
}

void find_devices(FlightPlan& plan) {
  const Model& model = *plan.scenario.bodies[0].model;
  for (const TapSeries& series : plan.definitions.series) {
    std::optional<std::size_t>& device = plan.device_of.emplace_back();
    if (series.is_of_joints()) continue;
    const int known = model.find_device(series.device);
    const bool fits = known >= 0 && static_cast<std::size_t>(value_count(model.devices[known])) == series.numbers;
    if (plan.has_model && known < 0)
      plan.remarks.push_back(warning(fmt::format("the model has no device '{}'", series.device)));
    else if (plan.has_model && !fits)
      plan.remarks.push_back(warning(fmt::format("the device '{}' of the model measures {} numbers, and the tap has {}",
                                                 series.device, value_count(model.devices[known]), series.numbers)));
    if (!fits && series.kind != TapSeries::Kind::imu) continue;
    device = plan.devices.size();
    plan.devices.push_back(fits ? model.devices[known] : Device{.name = series.device, .kind = Imu{}});
  }
}

void find_joints(FlightPlan& plan) {
  if (!plan.has_model) return;
  const Model& model = *plan.scenario.bodies[0].model;
  for (const TapSeries& series : plan.definitions.series)
    for (const std::string& name : series.names)
      if (model.find_joint(name) < 0) plan.remarks.push_back(warning(fmt::format("the model has no joint '{}'", name)));
}

}  // namespace

Result<std::unique_ptr<FlightPlan>> FlightPlan::of(const TapRing& ring, const std::string& name,
                                                   std::optional<std::int64_t> ticks) {
  auto plan = std::make_unique<FlightPlan>();
  plan->definitions = REHEARSE_TRY(ring.definitions());
  if (plan->definitions.series.empty())
    return error(fmt::format("the tap '{}' has no series: there is nothing to record", name));
  const std::string& body = plan->definitions.series[0].body;
  plan->label = body + "/" + ring.controller();
  plan->time_step = ring.time_step();
  const double whole = ticks ? static_cast<double>(*ticks) : std::floor(stated_duration / ring.time_step());
  plan->duration = std::max(1.0, whole) * ring.time_step();
  plan->has_model = !ring.model().empty();
  auto scenario = make_scenario(ring, name, body, plan->duration);
  if (!scenario) {  // the flight is recorded nevertheless
    append_as_warnings(scenario.errors(), plan->remarks);
    plan->remarks.push_back(warning("the recording has no model: it can be read, and replayed with a map alone"));
    plan->has_model = false;
  }
  plan->scenario = scenario ? *std::move(scenario) : bare_scenario(ring, name, body, plan->duration);
  find_devices(*plan);
  find_joints(*plan);
  plan->provenance = provenance_of(*plan, ring);
  plan->flight = plan->definitions.parameters;
  plan->flight.merge(mcap::StringMap{{"tap", name},
                                     {"process", std::to_string(ring.process())},
                                     {"memory_locked", ring.is_locked() ? "true" : "false"},
                                     {"monotonic_ns", std::to_string(ring.monotonic())},
                                     {"realtime_ns", std::to_string(ring.realtime())},
                                     {flight_facts::mathematics, mathematics_of_processor()}});
  plan->flight.merge(mcap::StringMap(plan->definitions.machine));
  return plan;
}

}  // namespace rehearse
