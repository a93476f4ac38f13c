#include <fmt/format.h>
#include <rehearse/audit.h>
#include <rehearse/mcap.h>
#include <rehearse/pin.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <set>

#include "aspects.h"
#include "base/clock.h"
#include "core/golden/golden_files.h"
#include "core/host/controller_library.h"
#include "core/host/virtualised.h"
#include "core/scenario/trace_scenario.h"
#include "instruction_profile.h"
#include "judgement.h"
#include "orders.h"
#include "realtime.h"
#include "valgrind_report.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

constexpr int most_places = 8;  // number of places that are tested separately

/// A controller of the run and the file of its library.
struct AuditedLibrary {
  std::string label;
  fs::path file;
};

/// The first difference of the commands that matters.
std::string difference_text(const ReplayPass& pass) {
  return pass.beyond
             ? "the commands leave their tolerances first at " + to_string(*pass.beyond)
             : "the commands are within tolerance, and differ first at " + to_string(*pass.differs_from_recording);
}

class Audit {
 public:
  Audit(const fs::path& subject, const AuditOptions& options) : subject_(subject), options_(options) {
    options_.scratch = fs::absolute(options.scratch);
  }

  Result<AuditReport> run();

 private:
  Result<void> prepare();
  Result<void> record();
  Result<void> find_libraries(const Scenario& scenario);
  Result<void> run_first();
  Result<void> run_experiments();
  Result<void> ask_places(const std::vector<ObservedCall>& seen, const std::vector<FactorResult>& factors,
                          std::vector<std::pair<CodePlace, bool>>& tried);
  Result<void> run_valgrind();
  Result<void> run_realtime();
  Result<void> run_instructions();
  Result<void> run_coverage();
  Result<void> run_orders();
  void take_first(const ReplayPass& pass);
  Result<void> judge();
  bool calls_can_hide() const;
  void sum_up();
  void tell(const std::string& what, int more) {
    all_ += more;
    what_ = what;
    if (options_.progress) options_.progress(what_, done_, all_);
  }

  fs::path subject_;
  AuditOptions options_;
  fs::path trace_;
  std::vector<AuditedLibrary> libraries_;
  std::optional<ReplayProcesses> processes_;
  Evidence evidence_;
  std::string what_;
  int done_ = 0, all_ = 0;
  AuditReport report_;
};

bool is_trace(const fs::path& file) { return file.extension() != ".yaml" && file.extension() != ".yml"; }

/// The reason why the recording is incomplete: a controller's effect on the process that recorded it.
std::string why_cut_off(const fs::path& log, int status) {
  if (const auto calls = read_call_log(log))
    for (auto call = calls->calls.rbegin(); call != calls->calls.rend(); ++call) {
      const std::string where = fmt::format("in {}() at tick {}", call->phase, call->first_tick);
      for (const char* function : {"exit", "_exit", "_Exit", "quick_exit"})
        if (call->function == function)
          return fmt::format("controller '{}' ended the process by {} {}", call->controller, text_of(*call), where);
      for (const char* function : {"close", "close_range", "closefrom"})
        if (call->function == function)
          return fmt::format("controller '{}' closed the recording by {} {}, called in {}", call->controller,
                             text_of(*call), where, place_of(*call));
    }
  return fmt::format("the recording has no end: its process ended with status {}", status);
}

Result<void> Audit::record() {
  tell("recording", 1);
  trace_ = recording_of_audit(options_.scratch);
  std::vector<std::string> words{options_.recorder.string(), "record", fs::absolute(subject_).string(), "-o",
                                 trace_.string()};
  for (const auto& [name, library] : options_.libraries)
    words.insert(words.end(), {"--controller", fmt::format("{}={}", name, library)});
  words.insert(words.end(), {"--call-limit", fmt::format("{}", options_.call_limit)});
  if (options_.until) words.insert(words.end(), {"--duration", fmt::format("{}", *options_.until)});
  const fs::path log = options_.scratch / "recording.calls", output = options_.scratch / "recording.txt";
  auto changes = REHEARSE_TRY(
      interposer_environment({log, options_.scratch / "copies", plain_replay(options_).everywhere, {}, {}}));
  for (const auto& [name, value] : pinned_environment()) changes[name] = value;
  if (options_.virtualise) changes.merge(virtualised_environment(options_.seed));
  const auto status = REHEARSE_TRY(run_to_end({words, environment_with(changes), output}, options_.should_stop));
  std::error_code ignored;
  if (!fs::exists(trace_, ignored)) {
    auto said = read_text(output);
    if (said && said->starts_with("error: ")) said = said->substr(7);
    while (said && said->ends_with('\n')) said->pop_back();
    return error(said && !said->empty() ? *said : fmt::format("recording it ended with status {}", status));
  }
  const auto reader = mcap::Reader::open(trace_);
  if (!reader || !(*reader)->damage().empty()) report_.failure = error(why_cut_off(log, status));
  evidence_.recorded_here = true;
  tell(what_, 0);
  ++done_;
  return {};
}

Result<void> Audit::find_libraries(const Scenario& scenario) {
  const fs::path folder = folder_of(scenario);
  const auto find = [&](const std::string& body, const ScenarioController& controller) -> Result<void> {
    const std::string label = body + "/" + controller.name;
    std::string name = controller.library;
    fs::path directory = folder;
    for (const std::string& key : {controller.name, label}) {
      const auto given = options_.libraries.find(key);
      if (given == options_.libraries.end()) continue;
      name = given->second;
      directory = fs::current_path();
    }
    const auto file = REHEARSE_TRY(find_controller_library(name, directory));
    libraries_.push_back({label, fs::absolute(file)});
    return {};
  };
  Diagnostics missing;
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers) {
      if (auto found = find(body.name, controller); !found) missing.push_back(found.errors()[0]);
      for (const ScenarioController& child : controller.children)
        if (auto found = find(body.name, child); !found) missing.push_back(found.errors()[0]);
    }
  if (!missing.empty()) return missing;
  std::set<std::string> known;
  for (const AuditedLibrary& library : libraries_) {
    known.insert(library.label);
    known.insert(library.label.substr(library.label.rfind('/') + 1));
  }
  for (const auto& [name, library] : options_.libraries)
    if (known.count(name) == 0) return error(fmt::format("there is no controller '{}' in {}", name, scenario.name));
  if (libraries_.empty()) return error(fmt::format("{} has no controllers: there is nothing to audit", scenario.name));
  // By absolute path, because a replay may use a different working folder.
  options_.libraries.clear();
  for (const AuditedLibrary& library : libraries_) options_.libraries[library.label] = library.file.string();
  return {};
}

Result<void> Audit::prepare() {
  std::error_code failed;
  fs::create_directories(options_.scratch, failed);
  if (failed) return error(fmt::format("the folder {} can't be made: {}", options_.scratch.string(), failed.message()));
  if (!fs::exists(subject_, failed)) return error(fmt::format("there is no {}", subject_.string()));
  if (is_trace(subject_)) {
    trace_ = fs::absolute(subject_);
  } else {
    const auto scenario = REHEARSE_TRY(Scenario::load(subject_));
    REHEARSE_TRY(find_libraries(scenario));
    REHEARSE_TRY(record());
  }
  if (report_.failure) return {};
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace_));
  if (!reader->damage().empty()) return reader->damage();
  const auto scenario = REHEARSE_TRY(scenario_of(*reader));
  evidence_.time_step = report_.time_step = scenario.time_step;
  evidence_.virtualised = options_.virtualise;
  if (const auto seed = virtualised_seed(*reader)) {
    options_.virtualise = evidence_.virtualised = true;  // as in the recording
    options_.seed = *seed;
  }
  if (is_trace(subject_)) REHEARSE_TRY(find_libraries(scenario));
  evidence_.fixed_addresses = can_fix_addresses();
  if (!evidence_.fixed_addresses) {
    Diagnostic& remark = report_.remarks.emplace_back(
        error("addresses can't be kept constant here (personality() is forbidden): a dependence on them is found, but "
              "can't be distinguished from chance"));
    remark.severity = Severity::note;
  }
  processes_.emplace(options_, trace_);
  processes_->on_progress = [this] {
    ++done_;
    tell(what_, 0);
  };
  return {};
}

Result<void> Audit::run_first() {
  tell("replaying", 2);
  auto outcomes = REHEARSE_TRY(processes_->run({plain_replay(options_), still_replay(options_)}));
  evidence_.plain = std::move(outcomes[0]);
  evidence_.still = std::move(outcomes[1]);
  take_first(evidence_.plain.passes[0]);
  return {};
}

/// Takes the size, the failure and the remarks of a run from its first replay.
void Audit::take_first(const ReplayPass& pass) {
  report_.ticks = pass.outputs.rows();
  report_.time = time_of(report_.ticks, evidence_.time_step);
  std::int64_t numbers = 0;
  for (const OutputField& field : pass.outputs.fields())
    numbers += field.kind == CellKind::floating && !field.channel.ends_with("/state") ? 1 : 0;
  report_.commands = report_.ticks * numbers;
  report_.controller_refused = pass.refused;
  if (pass.failure) report_.failure = error(*pass.failure);
  const auto refusal = std::ranges::find_if(pass.remarks, [](const Diagnostic& remark) {
    return remark.message.find(" returned false") != std::string::npos;
  });
  if (!report_.failure && pass.refused)
    report_.failure = error(refusal != pass.remarks.end() ? refusal->message : "a controller refused to take part");
  report_.remarks.insert(report_.remarks.end(), pass.remarks.begin(), pass.remarks.end());
}

/// True if controllers can make unlogged calls: system calls past the C library that can't be watched, or more kinds of
/// calls than entries in the log.
bool Audit::calls_can_hide() const {
  const auto can_hide = [](const CallLog& log) { return !log.complete || log.hidden_calls; };
  return can_hide(evidence_.plain.log) || can_hide(evidence_.still.log);
}

Result<void> Audit::run_experiments() {
  evidence_.experiments = plan_experiments(options_, calls_of(evidence_, ""), calls_can_hide());
  std::vector<ReplaySettings> all;
  for (const Experiment& experiment : evidence_.experiments)
    all.insert(all.end(), experiment.settings.begin(), experiment.settings.end());
  tell("replaying", static_cast<int>(all.size()));
  auto outcomes = REHEARSE_TRY(processes_->run(all));
  auto next = outcomes.begin();
  for (const Experiment& experiment : evidence_.experiments) {
    std::vector<ReplayOutcome>& taken = evidence_.outcomes.emplace_back();
    for (std::size_t i = 0; i < experiment.settings.size(); ++i) taken.push_back(std::move(*next++));
  }
  return {};
}

/// If the clock, random numbers or the machine matter and several places ask for them, tests each place separately.
Result<void> Audit::ask_places(const std::vector<ObservedCall>& seen, const std::vector<FactorResult>& factors,
                               std::vector<std::pair<CodePlace, bool>>& tried) {
  std::vector<ReplaySettings> settings;
  for (const Factor factor : {Factor::clock, Factor::random, Factor::machine}) {
    if (!differs_under(factors, factor)) continue;
    std::vector<const ObservedCall*> places;
    for (const ObservedCall& call : seen) {
      const auto same = [&](const ObservedCall* known) { return known->place == call.place; };
      if (aspect_of(call).factor == factor && std::ranges::none_of(places, same)) places.push_back(&call);
    }
    if (places.size() < 2) continue;
    if (places.size() > most_places) places.resize(most_places);
    for (const ObservedCall* call : places) {
      settings.push_back(other_answer_at(options_, *call, static_cast<int>(all_ + settings.size())));
      tried.emplace_back(call->place, false);
    }
  }
  tell("asking which call it is", static_cast<int>(settings.size()));
  const auto outcomes = REHEARSE_TRY(processes_->run(settings));
  const std::string& controller = seen.empty() ? std::string() : seen[0].controller;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    report_.replays += static_cast<int>(outcomes[i].passes.size());
    tried[i].second =
        difference(evidence_.still.passes[0], outcomes[i].passes[0], evidence_.time_step, controller).has_value();
  }
  return {};
}

Result<void> Audit::run_valgrind() {
  tell("running valgrind", 1);
  ReplaySettings settings;
  settings.name = "valgrind";
  settings.valgrind = ValgrindTool::memcheck;
  const auto outcomes = REHEARSE_TRY(processes_->run({settings}));
  const ReplayOutcome& outcome = outcomes[0];
  if (outcome.valgrind_report.empty())
    return error("valgrind can't be started", "apt-get install valgrind, or leave out --valgrind");
  std::vector<fs::path> files;
  for (const AuditedLibrary& library : libraries_) files.push_back(library.file);
  report_.memory_errors = memory_errors_in(outcome.valgrind_report, files);
  if (!outcome.passes[0].undefined.empty())
    report_.memory_errors.push_back("a command was never set: " + outcome.passes[0].undefined);
  report_.replays += 1;
  return {};
}

/// Replaces all other examinations.
Result<void> Audit::run_realtime() {
  tell("replaying", 1);
  ReplaySettings settings = plain_replay(options_);
  settings.name = "realtime";
  settings.costs = true;
  auto outcomes = REHEARSE_TRY(processes_->run({settings}));
  const ReplayOutcome& outcome = outcomes[0];
  take_first(outcome.passes[0]);
  report_.replays = 1;
  for (ControllerAudit& controller : report_.controllers) {
    controller.costs = costs_in(outcome.log, controller.controller);
    const auto faults = outcome.passes[0].page_faults.find(controller.controller);
    if (faults != outcome.passes[0].page_faults.end()) controller.page_faults = faults->second;
  }
  if (report_.failure) {
    report_.verdict = "failed: " + report_.failure->message;
  } else if (!outcome.passes[0].counted_costs) {
    report_.verdict = "unknown: the costs of control() can't be counted here";
  } else {
    report_.realtime_safe = std::ranges::none_of(report_.controllers, breaks_realtime);
    report_.verdict = realtime_verdict(report_, outcome.log.complete);
  }
  return {};
}

/// Replaces all other examinations.
Result<void> Audit::run_instructions() {
  constexpr double most_ticks = 100'000;
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace_));
  const auto& size = reader->statistics();
  const double seconds = size ? 1e-9 * static_cast<double>(size->message_end_time - size->message_start_time) : 0.0;
  if (const double ticks = std::min(seconds, options_.until.value_or(seconds)) / evidence_.time_step;
      ticks > most_ticks)
    return error(
        fmt::format("counting the instructions of {:.0f} ticks takes too long: the most are {:.0f}", ticks, most_ticks),
        fmt::format("--until {:g} ends it there", most_ticks * evidence_.time_step));
  tell("counting instructions under valgrind", 1);
  ReplaySettings settings;
  settings.name = "instructions";
  settings.valgrind = ValgrindTool::callgrind;
  settings.other_addresses = false;
  auto outcomes = REHEARSE_TRY(processes_->run({settings}));
  const ReplayOutcome& outcome = outcomes[0];
  take_first(outcome.passes[0]);
  report_.replays = 1;
  if (report_.failure) {
    report_.verdict = "failed: " + report_.failure->message;
    return {};
  }
  std::map<std::string, fs::path> files;
  for (const AuditedLibrary& library : libraries_) files[library.label] = fs::canonical(library.file);
  auto counts = REHEARSE_TRY(read_instruction_profiles(outcome.instruction_profile, files));
  for (ControllerAudit& controller : report_.controllers) {
    controller.instructions = std::move(counts[controller.controller]);
    report_.verdict +=
        (report_.verdict.empty() ? "" : "; ") + instructions_sentence(controller.controller, *controller.instructions);
  }
  if (outcome.passes[0].differs_from_recording)
    report_.remarks.push_back(
        warning("the counts are of another run than the recorded one: " + difference_text(outcome.passes[0])));
  return {};
}

/// Replaces all other examinations.
Result<void> Audit::run_coverage() {
  tell("replaying", 1);
  ReplaySettings settings = plain_replay(options_);
  settings.name = "coverage";
  settings.coverage = true;
  auto outcomes = REHEARSE_TRY(processes_->run({settings}));
  const ReplayPass& pass = outcomes[0].passes[0];
  take_first(pass);
  report_.replays = 1;
  for (ControllerAudit& controller : report_.controllers)
    if (const auto executed = pass.executed.find(controller.library); executed != pass.executed.end())
      controller.executed = executed->second;
  if (pass.differs_from_recording)
    report_.remarks.push_back(warning("the replay isn't the recorded run: " + difference_text(pass)));
  return {};
}

/// Replaces all other examinations.
Result<void> Audit::run_orders() {
  tell("replaying in other orders", options_.orders + 2);  // less if one is found, and more to reduce it
  return try_orders(*processes_, options_, report_, [this](const ReplayPass& pass) { take_first(pass); });
}

Result<void> Audit::judge() {
  for (ControllerAudit& controller : report_.controllers) {
    const std::vector<ObservedCall> seen = calls_of(evidence_, controller.controller);
    for (const ObservedCall& call : seen) controller.calls.push_back(describe(call, evidence_));
    if (report_.failure) continue;
    controller.factors = judge_factors(evidence_, controller.controller);
    std::vector<std::pair<CodePlace, bool>> tried;
    REHEARSE_TRY(ask_places(seen, controller.factors, tried));
    judge_calls(evidence_, seen, controller, tried);
    conclude(evidence_, seen, controller);
    controller.rests_on = what_it_rests_on(evidence_, seen, controller);
  }
  for (const std::string& liberty : liberties_of(calls_of(evidence_, ""))) report_.remarks.push_back(warning(liberty));
  return {};
}

std::string english_list(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

/// The first few, and the number of the others.
std::vector<std::string> shortened(std::vector<std::string> words) {
  constexpr std::size_t most = 3;
  if (words.size() <= most + 1) return words;
  const std::size_t more = words.size() - most;
  words.resize(most);
  words.push_back(fmt::format("{} more", more));
  return words;
}

/// "other memory, addresses, dates and random numbers"
std::string varied_in(const std::vector<FactorResult>& factors) {
  std::vector<std::string> words;
  const std::pair<Factor, const char*> names[] = {
      {Factor::memory, "memory"},  {Factor::addresses, "addresses"},   {Factor::environment, "variables"},
      {Factor::folder, "folders"}, {Factor::machine, "machines"},      {Factor::locale, "locale"},
      {Factor::clock, "dates"},    {Factor::random, "random numbers"}, {Factor::threads, "schedules of threads"}};
  for (const auto& [factor, name] : names)
    if (const FactorResult* result = find_factor(factors, factor); result && result->not_varied.empty())
      words.emplace_back(name);
  return "other " + english_list(words);
}

/// ", its 2 threads take turns", if there are any.
std::string turns_in(const std::vector<ControllerAudit>& controllers) {
  std::int64_t threads = 0;
  for (const ControllerAudit& controller : controllers)
    for (const AuditedCall& call : controller.calls)
      if (call.function == fmt::format("pthread_create({})", in_turns)) threads += call.count;
  if (threads == 0) return "";
  return fmt::format(", {} {}", controllers.size() == 1 ? "its" : "their",
                     threads == 1 ? "thread takes turns" : fmt::format("{} threads take turns", threads));
}

void Audit::sum_up() {
  const auto count = [&](const ReplayOutcome& outcome) { report_.replays += static_cast<int>(outcome.passes.size()); };
  count(evidence_.plain);
  count(evidence_.still);
  for (const auto& outcomes : evidence_.outcomes) std::ranges::for_each(outcomes, count);
  const std::string given =
      turns_in(report_.controllers) + (options_.virtualise ? ", with simulated time and seeded random numbers" : "");
  if (report_.failure) {
    report_.deterministic = false;
    report_.verdict = "failed: " + report_.failure->message;
    return;
  }
  std::vector<std::string> names, reasons;
  for (ControllerAudit& controller : report_.controllers) {
    names.push_back(controller.controller);
    if (!controller.deterministic)
      reasons.push_back(fmt::format("{} is not deterministic{}: {}", controller.controller, given, controller.reason));
  }
  if (reasons.empty() && !report_.memory_errors.empty())
    reasons.push_back(
        fmt::format("{} gave the same commands, but by chance: {}", english_list(names), report_.memory_errors[0]));
  else if (!reasons.empty() && !report_.memory_errors.empty())
    reasons.back() += "; valgrind: " + report_.memory_errors[0];
  report_.deterministic = reasons.empty();
  if (!reasons.empty()) {
    report_.verdict = reasons[0];
    for (std::size_t i = 1; i < reasons.size(); ++i) report_.verdict += "; " + reasons[i];
    return;
  }
  if (report_.commands == 0) {
    report_.verdict =
        fmt::format("nothing was compared: {} commanded nothing in {:g} s{}", english_list(names), report_.time, given);
    return;
  }
  std::vector<std::string> rests_on;
  for (const ControllerAudit& controller : report_.controllers)
    rests_on.insert(rests_on.end(), controller.rests_on.begin(), controller.rests_on.end());
  if (!rests_on.empty()) {
    report_.verdict = fmt::format(
        "{} gave the same {} commands{}, bit for bit, in {} replays of {:g} s under {}; wasn't varied, and may change "
        "them: {}",
        english_list(names), report_.commands, given, report_.replays, report_.time,
        varied_in(report_.controllers[0].factors), english_list(shortened(rests_on)));
    return;
  }
  report_.verdict = fmt::format(
      "{} {} of {} inputs{}: {} replays of {:g} s under {} gave the same {} commands, bit for bit", english_list(names),
      names.size() == 1 ? "is a function" : "are functions", names.size() == 1 ? "its" : "their", given,
      report_.replays, report_.time, varied_in(report_.controllers[0].factors), report_.commands);
}

Result<AuditReport> Audit::run() {
  REHEARSE_TRY(prepare());
  const auto only = options_.realtime       ? &Audit::run_realtime
                    : options_.instructions ? &Audit::run_instructions
                    : options_.coverage     ? &Audit::run_coverage
                    : options_.orders > 0   ? &Audit::run_orders
                                            : static_cast<Result<void> (Audit::*)()>(nullptr);
  if (!report_.failure && !only) REHEARSE_TRY(run_first());
  for (const AuditedLibrary& library : libraries_) {
    ControllerAudit& controller = report_.controllers.emplace_back();
    controller.controller = library.label;
    controller.library = library.file;
    if (only) continue;
    if (auto code = scan_library(library.file)) controller.code = *std::move(code);
  }
  if (only) {
    if (!report_.failure) REHEARSE_TRY((this->*only)());
    return report_;
  }
  if (!report_.failure) REHEARSE_TRY(run_experiments());
  if (options_.valgrind && !report_.failure) REHEARSE_TRY(run_valgrind());
  REHEARSE_TRY(judge());
  sum_up();
  return report_;
}

}  // namespace

std::string_view to_string(Factor factor) {
  switch (factor) {
    case Factor::nothing: return "nothing";
    case Factor::memory: return "memory";
    case Factor::addresses: return "addresses";
    case Factor::environment: return "environment";
    case Factor::machine: return "machine";
    case Factor::folder: return "folder";
    case Factor::locale: return "locale";
    case Factor::clock: return "clock";
    case Factor::random: return "random";
    case Factor::threads: return "threads";
    case Factor::again: return "again";
    case Factor::recording: return "recording";
  }
  return "";
}

std::string_view to_string(AuditedCall::Reached reached) {
  switch (reached) {
    case AuditedCall::Reached::yes: return "yes";
    case AuditedCall::Reached::no: return "no";
    case AuditedCall::Reached::unknown: return "unknown";
  }
  return "";
}

fs::path recording_of_audit(const fs::path& scratch) { return scratch / "recording.mcap"; }

Result<AuditReport> audit(const fs::path& scenario_or_trace, const AuditOptions& options) {
  return Audit(scenario_or_trace, options).run();
}

}  // namespace rehearse
