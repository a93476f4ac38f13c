#include "project_checks.h"

#include <fmt/format.h>
#include <rehearse/golden.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <set>
#include <string_view>
#include <thread>
#include <utility>

#include "base/write_hint.h"
#include "core/scenario/project.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = ProjectChecks::Json;

constexpr std::size_t most_output = std::size_t{1} << 15;  // of a build, for a page [bytes]

/// The build that was used last; empty: there is none.
fs::path newest_build(const fs::path& project) {
  fs::path newest;
  fs::file_time_type time{};
  std::error_code missing;
  for (const fs::path& folder : build_folders(project)) {
    const auto written = fs::last_write_time(folder / "CMakeCache.txt", missing);
    if (missing || (!newest.empty() && written <= time)) continue;
    newest = folder;
    time = written;
  }
  return newest;
}

/// The end of a text, from the beginning of a line on.
std::string end_of(std::string text) {
  if (text.size() <= most_output) return text;
  text.erase(0, text.size() - most_output);
  return text.substr(text.find('\n') + 1);
}

std::string last_line_of(std::string_view text) {
  while (text.ends_with('\n')) text.remove_suffix(1);
  return std::string(text.substr(text.rfind('\n') + 1));
}

std::int64_t milliseconds_since_1970() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// The expectation whose bound is nearest, with its share of the bound; null: none has one.
Json closest_of(const Json& checked) {
  Json closest = nullptr;
  for (const Json& expectation : checked.value("expectations", Json::array())) {
    const Json place = expectation.value("closest", Json());
    if (!place.is_object() || !place["share"].is_number()) continue;
    if (closest.is_null() || place["share"] < closest["share"])
      closest = {{"text", expectation.value("text", "")}, {"margin", place["text"]}, {"share", place["share"]}};
  }
  return closest;
}

/// The line of the first violated expectation; 1: there is none.
std::int64_t line_of(const Json& checked) {
  for (const Json& expectation : checked.value("expectations", Json::array()))
    if (!expectation.value("holds", true)) return expectation.value("line", std::int64_t{1});
  return 1;
}

/// "hold.yaml:3:7: message (hint)", without the parts that aren't known.
std::string text_of_error(const Json& error) {
  Diagnostic diagnostic;
  diagnostic.file = error.value("file", "");
  diagnostic.line = error.value("line", 0);
  diagnostic.column = error.value("column", 0);
  diagnostic.message = error.value("message", "");
  diagnostic.hint = error.value("hint", "");
  return to_string(diagnostic);
}

}  // namespace

ProjectChecks::ProjectChecks(ProjectChecksOptions options, SourceWatch watch)
    : options_(std::move(options)), watch_(std::move(watch)) {}

Result<ProjectChecks> ProjectChecks::open(ProjectChecksOptions options) {
  std::set<fs::path> without{options.project / "rehearse-pending"};
  for (const fs::path& build : build_folders(options.project)) without.insert(build);
  auto watch = REHEARSE_TRY(SourceWatch::open(options.project, std::move(without)));
  ProjectChecks checks(std::move(options), std::move(watch));
  std::ifstream allowed(checks.options_.allowed);
  for (std::string line; std::getline(allowed, line);) checks.is_allowed_ |= line == checks.options_.project.string();
  checks.list_scenarios();
  checks.check_all();
  return checks;
}

void ProjectChecks::list_scenarios() {
  std::vector<Scenario> now;
  for (const auto& files : {failure_files(options_.project), scenario_files(options_.project)})
    for (const fs::path& path : files) {
      if (!may_be_checked(path)) continue;
      Scenario scenario{path.lexically_relative(options_.project).string(), golden_in(path)};
      if (Scenario* known = find(scenario.file)) {
        std::swap(known->golden, scenario.golden);
        scenario = std::move(*known);
      }
      now.push_back(std::move(scenario));
    }
  scenarios_ = std::move(now);
}

ProjectChecks::Scenario* ProjectChecks::find(const std::string& file) {
  const auto found = std::ranges::find(scenarios_, file, &Scenario::file);
  return found == scenarios_.end() ? nullptr : &*found;
}

ChildProcess ProjectChecks::command(std::vector<std::string> words) const {
  words.insert(words.begin(), options_.command.string());
  ChildProcess process;
  process.words = std::move(words);
  process.environment = environment_with({{"REHEARSE_GOLDEN", std::nullopt}});
  process.errors = ChildProcess::Errors::apart;
  process.folder = options_.project;
  return process;
}

bool ProjectChecks::step() {
  const std::vector<fs::path> files = watch_.changed();
  if (!files.empty()) take_changes(files);
  bool has_changed = !files.empty();
  has_changed |= take_build();
  has_changed |= take_checks();
  if (!is_allowed_) return has_changed;
  has_changed |= start_build();
  has_changed |= start_checks();
  return has_changed;
}

void ProjectChecks::take_changes(const std::vector<fs::path>& files) {
  const auto needs_build = [&](const fs::path& file) {
    const fs::path within = file.lexically_relative(options_.project);
    return file.extension() != ".yaml" && file.extension() != ".md" && *within.begin() != "golden";
  };
  build_.is_wanted |= std::ranges::any_of(files, needs_build);
  list_scenarios();
  let_all_wait();
}

void ProjectChecks::check_all() {
  build_.is_wanted = true;
  let_all_wait();
}

void ProjectChecks::let_all_wait() {
  ++changes_;
  for (const Job& job : jobs_) job.program.signal(SIGTERM);
  for (Scenario& scenario : scenarios_) {
    scenario.phase = Phase::waits;
    scenario.wants_report = false;
  }
  if (build_.folder.empty()) build_.folder = newest_build(options_.project);
  build_.is_wanted &= !build_.folder.empty();
}

bool ProjectChecks::start_build() {
  // what still runs reads the libraries that a build replaces
  if (!build_.is_wanted || build_.job || !jobs_.empty()) return false;
  build_.is_wanted = false;
  build_.output.clear();
  ChildProcess process;
  process.words = {find_program("cmake").string(), "--build", build_.folder.string()};
  process.environment = environment_with({});
  process.folder = options_.project;
  auto program = process.words[0].empty() ? Result<RunningProgram>(error("there is no program cmake"))
                                          : RunningProgram::start(std::move(process));
  build_.has_failed = !program;
  if (program)
    build_.job = Job{"", *std::move(program), Clock::now()};
  else
    build_.output = to_string(program.errors());
  return true;
}

bool ProjectChecks::take_build() {
  if (!build_.job) return false;
  const auto status = build_.job->program.ended();
  std::string output = end_of(build_.job->program.output());
  const bool has_more = output != build_.output;
  build_.output = std::move(output);
  if (status && !*status) return has_more;
  build_.seconds = seconds_since(build_.job->begin);
  build_.has_failed = !status || **status != 0;
  build_.job.reset();
  return true;
}

ProjectChecks::Scenario* ProjectChecks::next() {
  Scenario* best = nullptr;
  const auto is_red = [](const Scenario& scenario) { return !scenario.has_passed(); };
  for (Scenario& scenario : scenarios_) {
    if (scenario.phase != Phase::waits) continue;
    if (looked_at_.contains(scenario.file)) return &scenario;
    if (!best || (is_red(scenario) && !is_red(*best))) best = &scenario;
  }
  return best;
}

ProjectChecks::Scenario* ProjectChecks::next_report() {
  const auto found = std::ranges::find_if(scenarios_, [&](const Scenario& scenario) {
    return scenario.wants_report && scenario.phase == Phase::judged && looked_at_.contains(scenario.file);
  });
  return found == scenarios_.end() ? nullptr : &*found;
}

Result<void> ProjectChecks::start_check(const Scenario& scenario, bool makes_report) {
  std::vector<std::string> words{"check", scenario.file, "--json"};
  if (!makes_report) words.emplace_back("--no-report");
  auto program = REHEARSE_TRY(RunningProgram::start(command(std::move(words))));
  jobs_.push_back({scenario.file, std::move(program), Clock::now(), changes_, makes_report});
  return {};
}

bool ProjectChecks::start_checks() {
  if (build_.job || build_.is_wanted || build_.has_failed) return false;
  bool has_begun = false;
  while (jobs_.size() < options_.jobs) {
    Scenario* scenario = next();
    if (!scenario) break;
    has_begun = true;
    scenario->phase = Phase::checking;
    if (const auto started = start_check(*scenario, false); !started) {
      scenario->phase = Phase::judged;
      scenario->result = {{"state", "unjudged"}, {"sentence", started.errors()[0].message}};
    }
  }
  while (jobs_.size() < options_.jobs) {
    Scenario* scenario = next_report();
    if (!scenario) break;
    scenario->wants_report = false;
    if (!start_check(*scenario, true)) break;
  }
  return has_begun;
}

bool ProjectChecks::take_checks() {
  bool has_ended = false;
  for (auto job = jobs_.begin(); job != jobs_.end();) {
    const auto status = job->program.ended();
    if (status && !*status) {
      ++job;
      continue;
    }
    has_ended = true;
    Scenario* scenario = find(job->file);
    // one that began before the last change was ended
    if (scenario && job->changes == changes_) take_verdict(*scenario, status ? **status : 2, *job);
    job = jobs_.erase(job);
  }
  return has_ended;
}

void ProjectChecks::take_verdict(Scenario& scenario, int status, const Job& job) {
  scenario.phase = Phase::judged;
  scenario.report.clear();
  scenario.wants_report = !job.makes_report && (status == 1 || status == 3);
  Json& result = scenario.result;
  const Json earlier = job.makes_report ? result : Json::object();  // the check's own, without its report
  result = {{"state", status == 0   ? "passed"
                      : status == 1 ? "differs"
                      : status == 3 ? "failed"
                                    : "unjudged"},
            {"sentence", "rehearse check told nothing"},
            {"seconds", earlier.value("seconds", seconds_since(job.begin))},
            {"at", earlier.value("at", milliseconds_since_1970())},
            {"told", end_of(job.program.errors())}};
  if (const std::string told = job.program.errors(); !told.empty()) result["sentence"] = last_line_of(told);
  try {
    take_answer(scenario, Json::parse(job.program.output()));
  } catch (const Json::exception&) {
    // it ended before it wrote its answer; the sentence is what it wrote to stderr
  }
}

void ProjectChecks::take_answer(Scenario& scenario, const Json& checked) {
  Json& result = scenario.result;
  if (const Json errors = checked.value("errors", Json::array()); !errors.empty()) {
    result["sentence"] = text_of_error(errors[0]);
    result["line"] = errors[0].value("line", 1);
    return;
  }
  result["sentence"] = checked.at("verdict");
  for (const char* key : {"codes", "equal", "proved", "not_proved", "levels", "first", "message", "remarks"})
    if (const auto found = checked.find(key); found != checked.end()) result[key] = *found;
  result["line"] = line_of(checked);
  result["closest"] = closest_of(checked);
  if (const Json report = checked.value("report", Json()); report.is_string())
    scenario.report = options_.project / report.get<std::string>();
}

void ProjectChecks::stop() {
  for (const Job& job : jobs_) job.program.signal(SIGTERM);
  if (build_.job) build_.job->program.signal(SIGTERM);
  for (int rounds = 0; rounds < 100 && (build_.job || !jobs_.empty()); ++rounds) {
    take_build();
    take_checks();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

Result<void> ProjectChecks::allow() {
  if (std::exchange(is_allowed_, true) || options_.allowed.empty()) return {};
  std::error_code failed;
  fs::create_directories(options_.allowed.parent_path(), failed);
  std::ofstream list(options_.allowed, std::ios::app);
  list << options_.project.string() << '\n';
  list.close();
  if (list) return {};
  return error(fmt::format("can't write {}: the next start asks again", options_.allowed.string()),
               write_hint(options_.allowed, ""));
}

Result<void> ProjectChecks::look_at(const std::string& file) {
  Scenario* scenario = find(file);
  if (!scenario) return error(fmt::format("the project has no scenario '{}'", file));
  looked_at_.insert(file);
  return {};
}

Result<void> ProjectChecks::decide(const std::string& golden, bool is_accepted) {
  const GoldenStore store(options_.project / "golden", pending_folder(options_.project / ""));
  const std::vector<std::string> waiting = store.pending();
  if (std::ranges::find(waiting, golden) == waiting.end())
    return error(fmt::format("no run waits as '{}'", golden), "it was decided on already");
  ChildProcess process = command({"golden", is_accepted ? "accept" : "reject", golden});
  process.errors = ChildProcess::Errors::with_output;
  constexpr double patience = 60.0;  // [s]
  const auto told = REHEARSE_TRY(output_of(std::move(process), patience));
  if (told.status == 0) return {};
  return error(told.status ? last_line_of(told.text) : fmt::format("rehearse golden took more than {:g} s", patience));
}

Result<fs::path> ProjectChecks::report_of(const std::string& file) const {
  const auto found = std::ranges::find(scenarios_, file, &Scenario::file);
  if (found != scenarios_.end() && !found->report.empty()) return found->report;
  return error(fmt::format("'{}' has no report", file), "a check that fails writes one");
}

bool ProjectChecks::is_reported(const Scenario& scenario) const {
  return std::ranges::any_of(jobs_, [&](const Job& job) { return job.makes_report && job.file == scenario.file; });
}

Json ProjectChecks::json_of(const Scenario& scenario) const {
  constexpr const char* words[] = {"unknown", "waits", "checking", "judged"};
  return {{"file", scenario.file},     {"name", fs::path(scenario.file).stem().string()},
          {"golden", scenario.golden}, {"phase", words[static_cast<std::size_t>(scenario.phase)]},
          {"result", scenario.result}, {"report", !scenario.report.empty()}};
}

Json ProjectChecks::state() const {
  const GoldenStore store(options_.project / "golden", pending_folder(options_.project / ""));
  Json scenarios = Json::array(), waiting = Json::array();
  for (const Scenario& scenario : scenarios_) scenarios.push_back(json_of(scenario));
  for (const std::string& name : store.pending())
    waiting.push_back({{"golden", name}, {"sentence", store.pending_verdict(name)}, {"is_first", !store.has(name)}});
  const char* const build_state = build_.job          ? "runs"
                                  : build_.has_failed ? "failed"
                                  : build_.is_wanted  ? "waits"
                                                      : "done";
  return {{"project", options_.project.string()},
          {"allowed", is_allowed_},
          {"build",
           {{"folder", build_.folder.empty() ? "" : build_.folder.lexically_proximate(options_.project).string()},
            {"state", build_state},
            {"seconds", build_.seconds},
            {"line", last_line_of(build_.output)},
            {"output", build_.has_failed ? build_.output : ""}}},
          {"scenarios", scenarios},
          {"waiting", waiting}};
}

}  // namespace rehearse
