#include "check_flight.h"

#include <fmt/format.h>
#include <rehearse/replay.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "base/clock.h"
#include "base/text.h"
#include "core/guard/interruption.h"
#include "core/guard/own_process.h"
#include "core/guard/supervise.h"
#include "core/host/controller_library.h"
#include "core/simulation/forced_run.h"
#include "flight.h"
#include "output.h"
#include "progress.h"
#include "replay_verdict.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

/// The library of the scenario's controller that has the flight's name.
Result<std::string> library_for(const Scenario& scenario, const Flight& flight) {
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers)
      if (controller.name == flight.controller) {
        const auto found =
            REHEARSE_TRY(find_controller_library(controller.library, fs::path(scenario.file).parent_path()));
        return found.string();
      }
  return error_in(scenario.file, fmt::format("it has no controller '{}', which the flight has", flight.controller));
}

void tell_world(const Scenario& scenario, const ForcedReport& report) {
  const ForcedJoint* const first = report.first();
  if (!first)
    fmt::print("the world agrees with the robot in {}, within the noise of the flight\n",
               count_text(report.steps, "step"));
  else
    fmt::print("the world differs from the robot from tick {} ({:.6g} s) on: {} lacks {:.3g} {} at tick {}\n",
               *first->from, time_of(*first->from, scenario.time_step), first->name, first->missing,
               first->is_linear ? "m/s²" : "rad/s²", first->worst);
  fmt::print("  mean accelerations over {:g} s that the world lacks, beside what noise may give:\n", report.span);
  fmt::print("  {:<24} {:>12} {:>12} {:>10}  from tick\n", "joint", "largest", "noise", "at tick");
  for (const ForcedJoint& joint : report.joints)
    fmt::print("  {:<24} {:>12.3g} {:>12.3g} {:>10}  {}\n", joint.name, joint.missing, joint.floor, joint.worst,
               joint.from ? std::to_string(*joint.from) : "-");
}

/// "agrees", "differs" or "undecided".
const char* word_on_world(const ForcedReport& report) {
  if (!report.undecided.empty()) return "undecided";
  return report.first() ? "differs" : "agrees";
}

Json world_json(const ForcedReport& report) {
  Json joints = Json::array();
  for (const ForcedJoint& joint : report.joints)
    joints.push_back({{"name", joint.name},
                      {"unit", joint.is_linear ? "m/s^2" : "rad/s^2"},
                      {"missing", joint.missing},
                      {"noise", joint.floor},
                      {"tick", joint.worst},
                      {"from", joint.from ? Json(*joint.from) : Json(nullptr)}});
  return {{"verdict", word_on_world(report)},
          {"undecided", report.undecided.empty() ? Json(nullptr) : Json(report.undecided)},
          {"steps", report.steps},
          {"span", report.span},
          {"joints", joints}};
}

}  // namespace

Exit check_with_flight(const Scenario& scenario, const std::string& file, const HostOptions& host, bool json) {
  const auto flight = flight_in(file);
  if (!flight) return refuse(error_in(file, "it is no flight with a model", "rehearse tap makes flights"));
  take_mathematics_of(*flight);
  supervise_process();
  end_runs_on_signals();
  ReplayOptions options;
  static_cast<HostOptions&>(options) = host;
  if (options.libraries.empty()) {
    const auto library = library_for(scenario, *flight);
    if (!library) return refuse(library.errors());
    options.libraries.emplace(flight->controller, *library);
  }
  const auto replayed = [&] {
    Progress progress("replaying");
    options.progress = [&](std::int64_t done, std::int64_t all) { progress.show(done, all); };
    return replay(file, options);
  }();
  if (!replayed) return refuse(replayed.errors());
  if (!json)
    fmt::print("{} beside {}\ncontroller: {}\n  {}\n", scenario.name, file, replay_verdict(*replayed),
               mathematics_line(*flight));
  std::fflush(stdout);
  const auto recording = Trace::load_in_pieces(file, [](const Trace&) {});
  if (!recording) return refuse(recording.errors());
  const auto world = [&] {
    Progress progress("stepping the world");
    return compare_with_flight(scenario, *recording,
                               [&](std::int64_t done, std::int64_t all) { progress.show(done, all); });
  }();
  end_if_reader_is_gone();
  if (!world) return refuse(world.errors());
  if (json) {
    print({{"scenario", scenario.name},
           {"flight", file},
           {"mathematics", mathematics_line(*flight)},
           {"controller", replay_json(*replayed, {})},
           {"plant", world_json(*world)}});
  } else {
    fmt::print("plant: ");
    if (!world->undecided.empty())
      fmt::print("undecided: state missing: {}\n", world->undecided);
    else
      tell_world(scenario, *world);
    std::fflush(stdout);
    tell_remarks(replayed->remarks, replayed->failure);
  }
  if (replayed->failure || replayed->controller_refused) return Exit::controller_failed;
  if (!replay_holds(*replayed) || world->first()) return Exit::differs;
  return world->undecided.empty() ? Exit::done : Exit::odd;
}

}  // namespace rehearse::tool
