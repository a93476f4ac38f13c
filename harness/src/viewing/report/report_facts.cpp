#include "report_facts.h"

#include <rehearse/mcap.h>

#include <cstdint>
#include <utility>

#include "core/host/control_times_json.h"
#include "core/trace/run_facts.h"

namespace rehearse {

std::string outcome_of(const RunFacts& run) {
  return run.outcome ? run.outcome->failure.value_or("") : "the recording was cut: it lacks the end of the run";
}

ReportJson json_of(const CallStack& stack) {
  ReportJson frames = ReportJson::array();
  for (const StackFrame& frame : stack.frames)
    frames.push_back({{"function", frame.function},
                      {"file", frame.file},
                      {"line", frame.line},
                      {"begin", frame.begin},
                      {"source", frame.source}});
  return {{"controller", stack.controller},
          {"command", stack.command},
          {"tick", stack.tick},
          {"frames", std::move(frames)}};
}

ReportJson json_of(const std::vector<ControlTimes>& all) {
  ReportJson entries = ReportJson::array();
  for (const ControlTimes& times : all) entries.push_back(json_of(times));
  return entries;
}

ReportJson run_json(const ReportedRun& run, std::string_view role, const std::filesystem::path& file) {
  const Trace& trace = run.trace;
  const RunFacts stated = RunFacts::of(trace);
  ReportJson provenance = ReportJson::object();
  if (stated.provenance)
    for (const auto& [key, value] : *stated.provenance) provenance[key] = value;
  const mcap::Attachment* scenario = trace.find_attachment("scenario.yaml");
  ReportJson remarks = ReportJson::array();
  for (const Diagnostic& damage : trace.damage()) remarks.push_back(damage.message);
  return {
      {"role", role},
      {"file", file.filename().string()},
      {"ticks", stated.ticks(static_cast<std::int64_t>(run.clock.size()))},
      {"complete", stated.outcome && !stated.outcome->failure},
      {"outcome", outcome_of(stated)},
      {"facts", std::move(provenance)},
      {"scenario", scenario ? std::string(reinterpret_cast<const char*>(scenario->data.data()), scenario->data.size())
                            : std::string()},
      {"remarks", std::move(remarks)}};
}

double time_step_of(const ReportedRun& run, const std::optional<Scenario>& scenario) {
  if (scenario) return scenario->time_step;
  constexpr double usual = 0.001;
  const std::uint64_t step = run.clock.size() < 2 ? 0 : run.clock.time(1) - run.clock.first_time();  // [ns]
  return step == 0 ? usual : static_cast<double>(step) / 1e9;
}

}  // namespace rehearse
