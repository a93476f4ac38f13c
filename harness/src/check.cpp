#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/picture_difference.h>

#include <nlohmann/json.hpp>

#include "report_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

LevelState state_of(const Comparison& comparison) {
  if (comparison.equal) return LevelState::equal;
  return comparison.within ? LevelState::within : LevelState::differs;
}

/// The libraries of the scenario as it is now: the golden's own scenario knows names only, not where paths begin.
HostOptions host_options(const Scenario& scenario, const HostOptions& given) {
  HostOptions options = given;
  const auto add = [&](const ScenarioBody& body, const ScenarioController& controller) {
    const fs::path file = fs::path(scenario.file).parent_path() / controller.library;
    std::error_code ignored;
    if (given.libraries.count(controller.name) == 0 && fs::is_regular_file(file, ignored))
      options.libraries.emplace(body.name + "/" + controller.name, fs::absolute(file, ignored).string());
  };
  for (const ScenarioBody& body : scenario.bodies) {
    for (const ScenarioController& controller : body.controllers) {
      add(body, controller);
      for (const ScenarioController& child : controller.children) add(body, child);
    }
  }
  return options;
}

/// Which part changed, when the controller is known to be the same or isn't known.
std::string closed_verdict(const Comparison& comparison, LevelState controller) {
  if (comparison.within || controller != LevelState::equal) return verdict(comparison);
  const Divergence& first = *comparison.first;
  // what is beyond tolerance first may follow from something that is within it
  const bool follows = first.stage == Stage::controller || first.stage == Stage::inputs;
  const Stage guilty = follows ? comparison.first_bit->stage : first.stage;
  if (guilty == Stage::controller && comparison.first_bit->element != "output_hash" && first.note.empty())
    return fmt::format(
        "the controller repeats its recorded commands, but in a run of its own it doesn't: it depends on "
        "something that is no input of its; it {}",
        verdict(comparison));
  return fmt::format("{} changed, the controller did not: the run {}", to_string(guilty), verdict(comparison));
}

void judge_controller(const Result<ReplayReport>& replay, CheckReport& report) {
  report.controller = LevelState::differs;
  if (!replay) {
    report.verdict = "the controllers can't be fed with the golden's inputs: " + replay.errors()[0].message;
    return;
  }
  report.replay = *replay;
  report.first = replay->first;
  if (replay->equal()) {
    report.controller = LevelState::equal;
  } else if (replay->first) {
    report.verdict = "the controller changed: fed with the golden's inputs, it differs at " + to_string(*replay->first);
  } else {
    report.verdict = "the controller changed: fed with the golden's inputs, " + replay->failure->message;
  }
}

void judge_closed(Comparison comparison, CheckReport& report) {
  report.closed = state_of(comparison);
  if (report.controller != LevelState::differs) {
    report.verdict = closed_verdict(comparison, report.controller);
    report.first = comparison.first ? comparison.first : comparison.first_bit;
  }
  report.comparison = std::move(comparison);
}

Result<RunSummary> make_run(const Scenario& scenario, const fs::path& actual, const CheckOptions& options,
                            const RecordRun& record) {
  std::error_code failed;
  if (actual.has_parent_path()) fs::create_directories(actual.parent_path(), failed);
  if (failed)
    return error(fmt::format("the folder {} can't be made: {}", actual.parent_path().string(), failed.message()));
  return record(scenario, actual, options.run);
}

}  // namespace

std::string_view to_string(LevelState state) {
  switch (state) {
    case LevelState::equal: return "equal";
    case LevelState::within: return "within";
    case LevelState::differs: return "differs";
    case LevelState::skipped: return "skipped";
  }
  return "";
}

bool CheckReport::equal() const {
  for (const LevelState level : {controller, plant, closed})
    if (level != LevelState::equal && level != LevelState::skipped) return false;
  return true;
}

bool CheckReport::within() const {
  for (const LevelState level : {controller, plant, closed})
    if (level == LevelState::differs) return false;
  return true;
}

Result<CheckReport> check_scenario(const Scenario& scenario, const fs::path& golden, const fs::path& actual,
                                   const CheckOptions& options, const RecordRun& record) {
  CheckReport report;
  const auto expected = Trace::load(golden);
  if (!expected) return expected.errors();
  if (options.closed) {  // first, because it knows best why a run can't begin
    auto run = make_run(scenario, actual, options, record);
    if (!run) return run.errors();
    report.run = std::move(*run);
  }
  if (options.controller) {
    ReplayOptions replaying;
    static_cast<HostOptions&>(replaying) = host_options(scenario, options.run);
    const auto replayed = replay(golden, replaying);
    if (!replayed && !options.closed) return replayed.errors();
    judge_controller(replayed, report);
  }
  if (options.closed) {
    const auto fresh = Trace::load(actual);
    if (!fresh) return fresh.errors();
    judge_closed(compare(*expected, *fresh, scenario.tolerances), report);
    if (!report.within())
      report.message = fmt::format(
          "this run: {}{}", actual.string(),
          picture_lines(write_picture_differences(*expected, *fresh, *report.comparison, scenario.tolerances, actual)));
  } else if (report.controller == LevelState::equal) {
    report.verdict = fmt::format("the controller repeats {} recorded ticks bit for bit", report.replay->ticks);
  }
  std::error_code ignored;
  if (report.within()) {
    fs::remove(actual, ignored);
    remove_picture_differences(actual);
  }
  return report;
}

namespace {

/// There is no golden yet: the run becomes it, or waits to be.
Result<CheckReport> first_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const RecordRun& record) {
  CheckReport report;
  const fs::path actual = store.pending_file(scenario.golden);
  auto run = make_run(scenario, actual, options, record);
  if (!run) return run.errors();
  report.run = std::move(*run);
  if (mode == GoldenMode::check) {
    report.closed = LevelState::differs;
    report.verdict = fmt::format("there is no golden {}", store.trace_file(scenario.golden).string());
    report.message =
        fmt::format("this run: {}\nif it is right: rehearse golden accept {}", actual.string(), scenario.golden);
    return report;
  }
  if (auto accepted = store.accept_pending(scenario.golden); !accepted) return accepted.errors();
  report.golden_written = true;
  report.verdict = fmt::format("wrote the new golden {}", store.trace_file(scenario.golden).string());
  return report;
}

}  // namespace

Result<CheckReport> check_golden(const Scenario& scenario, GoldenStore& store, GoldenMode mode,
                                 const CheckOptions& options, const RecordRun& record) {
  const std::string& name = scenario.golden;
  if (name.empty()) {
    Diagnostic finding = error("the scenario names no golden to compare with", "golden: Suite.Test");
    finding.file = scenario.file;
    return finding;
  }
  if (!store.has(name)) return first_golden(scenario, store, mode, options, record);
  const fs::path actual = store.pending_file(name);
  auto report = check_scenario(scenario, store.trace_file(name), actual, options, record);
  if (!report) return report;
  const bool waits = options.closed && !report->within();
  if (waits && mode == GoldenMode::accept) {
    if (auto accepted = store.accept_pending(name); !accepted) return accepted.errors();
    report->golden_written = true;
    report->message = fmt::format("replaced {}", store.trace_file(name).string());
  } else if (waits) {
    report->message += fmt::format("\nif it is right: rehearse golden accept {}", name);
  } else if (const auto digest = store.check_digest(name); !digest) {
    return digest.errors();
  }
  return report;
}

std::string to_json(const CheckReport& report) {
  const nlohmann::ordered_json object{{"verdict", report.verdict},
                                      {"equal", report.equal()},
                                      {"within", report.within()},
                                      {"levels",
                                       {{"controller", to_string(report.controller)},
                                        {"plant", to_string(report.plant)},
                                        {"closed", to_string(report.closed)}}},
                                      {"first", json_of(report.first)}};
  return text_of(object);
}

}  // namespace rehearse
