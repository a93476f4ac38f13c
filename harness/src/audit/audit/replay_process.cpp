#include "replay_process.h"

#include <fmt/format.h>
#include <rehearse/pin.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/compare/place_json.h"
#include "core/golden/golden_files.h"
#include "core/host/virtualised.h"
#include "executed_code_json.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr int at_a_time = 2;
constexpr std::chrono::milliseconds poll_interval{1};
constexpr std::chrono::milliseconds heartbeat_interval{250};
constexpr double patience = 10.0;  // time after the limit of a call until a silent process is killed [s]
constexpr double valgrind_slowness = 50.0;

/// True for variables that a replay needs, or that influence its arithmetic: they are equal in all replays.
bool is_needed(const std::string& name) {
  for (const char* kept : {"PATH", "GLIBC_TUNABLES", "GALLIUM_OVERRIDE_CPU_CAPS", "LP_NUM_THREADS", "LOCPATH"})
    if (name == kept) return true;
  for (const char* prefix : {"REHEARSE_", "LD_", "ASAN_", "UBSAN_", "LSAN_", "TSAN_", "VALGRIND_"})
    if (name.starts_with(prefix)) return true;
  return false;
}

/// Removes the user's variables, sets the usual ones to different values, and adds 100 kB.
void change_environment(EnvironmentChanges& changes, const fs::path& home) {
  for (char** entry = environ; *entry; ++entry) {
    const std::string name(*entry, std::min(strcspn(*entry, "="), strlen(*entry)));
    if (!is_needed(name)) changes.emplace(name, std::nullopt);
  }
  const std::pair<const char*, std::string> others[] = {
      {"HOME", home.string()}, {"USER", "somebody-else"}, {"LOGNAME", "somebody-else"}, {"HOSTNAME", "elsewhere"},
      {"TZ", "XST-9:30"},      {"TMPDIR", home.string()}, {"EDITOR", "none"},           {"TERM", "dumb"}};
  for (const auto& [name, value] : others) changes[name] = value;
  for (int i = 0; i < 100; ++i) changes[fmt::format("AUDIT_FILLER_{}", i)] = std::string(1000, 'x');
}

/// The tunables of malloc(), a colon after each.
std::string memory_tunables(const ReplaySettings& settings) {
  std::string memory;
  // Without its cache malloc() fills every block that it returns or frees; trimmed blocks would come back as zeros.
  if (settings.fill != 0)
    memory += fmt::format("glibc.malloc.tcache_count=0:glibc.malloc.trim_threshold={}:glibc.malloc.perturb={}:",
                          std::size_t{1} << 40, settings.fill);
  if (settings.padding != 0)
    memory += "glibc.malloc.top_pad=1048576:glibc.malloc.mmap_threshold=60000:glibc.malloc.arena_max=1:";
  return memory;
}

double slowness_of(const ReplaySettings& settings) {
  return settings.valgrind == ValgrindTool::none ? 1.0 : valgrind_slowness;
}

std::string sentence_of_death(int status, const std::optional<UnfinishedCall>& call) {
  const int exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  const std::string how = exit_status <= 128
                              ? fmt::format("ended the process, with exit status {},", exit_status)
                              : fmt::format("ended the process by a signal ({})", strsignal(exit_status - 128));
  if (call)
    return fmt::format("controller '{}' {} in {}() at tick {}", call->controller, how, call->function, call->tick);
  return fmt::format("something that a controller left behind, as a thread or a handler, {}", how);
}

}  // namespace

struct ReplayProcesses::Child {
  const ReplaySettings* settings = nullptr;
  std::size_t number = 0;  // index in the list of requested replays
  fs::path folder;
  pid_t process = 0;
  int status = 0;
  bool killed = false;
  Clock::time_point last_looked = Clock::now(), last_beat = last_looked;
  std::uint64_t beat = 0;
};

ReplayProcesses::ReplayProcesses(const AuditOptions& options, fs::path trace)
    : options_(options), trace_(std::move(trace)) {}

// Paths of one length: the length of a path changes the layout of the heap, and with it the order of pointers.
fs::path ReplayProcesses::folder_of(const ReplaySettings& settings) const {
  constexpr std::size_t width = 32;
  REHEARSE_ASSERT(settings.name.size() <= width, "all replays have names of at most this length");
  return options_.scratch / fmt::format("{:_<{}}", settings.name, width);
}

fs::path ReplayProcesses::profile_of(const ReplaySettings& settings) const {
  return folder_of(settings) / "instructions";
}

std::vector<std::string> ReplayProcesses::command_line(const ReplaySettings& settings) const {
  std::vector<std::string> words;
  if (settings.valgrind != ValgrindTool::none)
    words = {"/usr/bin/env", "valgrind", "--quiet", "--trace-children=yes", "--child-silent-after-fork=yes"};
  if (settings.valgrind == ValgrindTool::memcheck)
    words.insert(words.end(), {"--tool=memcheck", "--track-origins=yes", "--num-callers=40", "--leak-check=no",
                               "--xml=yes", "--xml-file=" + (folder_of(settings) / "valgrind.%p.xml").string()});
  if (settings.valgrind == ValgrindTool::callgrind)
    words.insert(words.end(),
                 {"--tool=callgrind", "--instr-atstart=no", "--collect-atstart=no", "--combine-dumps=yes",
                  "--compress-pos=no", "--dump-instr=yes", "--callgrind-out-file=" + profile_of(settings).string()});
  words.insert(words.end(), {options_.auditor.string(), "audit", trace_.string(), "--replay-into",
                             folder_of(settings).string(), "--passes", std::to_string(settings.passes)});
  if (settings.padding != 0) words.insert(words.end(), {"--padding", std::to_string(settings.padding)});
  if (settings.fill != 0) words.insert(words.end(), {"--stack-fill", std::to_string(settings.fill ^ 0xff)});
  if (!settings.order.empty()) words.insert(words.end(), {"--order", settings.order.string()});
  if (settings.costs) words.push_back("--costs");
  if (settings.coverage) words.push_back("--executed");
  if (settings.valgrind == ValgrindTool::callgrind) words.push_back("--profile");
  if (options_.until) words.insert(words.end(), {"--until", fmt::format("{}", *options_.until)});
  const double limit = options_.call_limit * slowness_of(settings);
  words.insert(words.end(), {"--call-limit", fmt::format("{}", std::min(limit, 86400.0))});
  for (const auto& [name, library] : options_.libraries)
    words.insert(words.end(), {"--controller", fmt::format("{}={}", name, library)});
  return words;
}

Result<std::vector<std::string>> ReplayProcesses::environment(const ReplaySettings& settings) const {
  EnvironmentChanges changes = settings.environment;
  if (settings.other_environment) change_environment(changes, folder_of(settings));
  for (const auto& [name, value] : pinned_environment()) changes[name] = value;
  if (options_.virtualise) changes.merge(virtualised_environment(options_.seed));
  changes["GLIBC_TUNABLES"] = memory_tunables(settings) + changes["GLIBC_TUNABLES"].value_or("");
  if (settings.valgrind == ValgrindTool::callgrind) {
    changes["LD_BIND_NOW"] = "1";  // else the first call of a function also looks up its address
  } else if (settings.valgrind == ValgrindTool::none) {
    const auto watched =
        REHEARSE_TRY(interposer_environment({folder_of(settings) / "calls", folder_of(settings) / "copies",
                                             settings.everywhere, settings.only, settings.there}));
    for (const auto& [name, value] : watched) changes[name] = value;
  }
  return environment_with(changes);
}

Result<ReplayProcesses::Child> ReplayProcesses::start(const ReplaySettings& settings) {
  Child child;
  child.settings = &settings;
  child.folder = folder_of(settings);
  const fs::path elsewhere = child.folder / "elsewhere";
  std::error_code failed;
  fs::create_directories(elsewhere, failed);
  if (failed) return error(fmt::format("the folder {} can't be made: {}", elsewhere.string(), failed.message()));
  const auto variables = REHEARSE_TRY(environment(settings));
  child.process = REHEARSE_TRY(rehearse::start({.words = command_line(settings),
                                                .environment = variables,
                                                .output = child.folder / "output.txt",
                                                .folder = settings.other_folder ? elsewhere : fs::path(),
                                                .fixed_addresses = !settings.other_addresses}));
  return child;
}

/// Checks once. A process without a finished call for too long is killed: its controllers block the watchdog of the
/// replay itself, or a thread of theirs never ends.
bool ReplayProcesses::has_ended(Child& child) const {
  const pid_t ended = waitpid(child.process, &child.status, WNOHANG);
  if (ended != 0 && !(ended < 0 && errno == EINTR)) return true;
  const Clock::time_point now = Clock::now();
  if (now - child.last_looked < heartbeat_interval) return false;
  child.last_looked = now;
  std::uint64_t beat = 0;
  for (int pass = 1; pass <= child.settings->passes; ++pass)
    beat += heartbeat_of(child.folder / fmt::format("{}.outputs", pass)).value_or(0);
  if (beat != child.beat) child.last_beat = now;
  child.beat = beat;
  const double silent = std::chrono::duration<double>(now - child.last_beat).count();
  if (!child.killed && silent > (options_.call_limit + patience) * slowness_of(*child.settings)) {
    child.killed = true;
    ::kill(child.process, SIGKILL);
  }
  return false;
}

Result<std::vector<ReplayOutcome>> ReplayProcesses::run(const std::vector<ReplaySettings>& settings) {
  std::vector<ReplayOutcome> outcomes(settings.size());
  std::vector<Child> running;
  std::size_t next = 0;
  Diagnostics problems;
  while (next < settings.size() || !running.empty()) {
    if (problems.empty() && options_.should_stop && options_.should_stop()) {
      problems.push_back(error("the audit was stopped"));
      for (const Child& child : running) ::kill(child.process, SIGKILL);
    }
    while (problems.empty() && next < settings.size() && running.size() < at_a_time) {
      auto child = start(settings[next]);
      if (!child) {
        problems = child.errors();
        break;
      }
      child->number = next++;
      running.push_back(*std::move(child));
    }
    for (auto child = running.begin(); child != running.end();) {
      if (!has_ended(*child)) {
        ++child;
        continue;
      }
      auto result = outcome(*child);
      if (!result && problems.empty()) problems = result.errors();
      if (result) outcomes[child->number] = *std::move(result);
      child = running.erase(child);
      if (on_progress) on_progress();
    }
    if (!problems.empty() && running.empty()) return problems;
    std::this_thread::sleep_for(poll_interval);
  }
  return outcomes;
}

Result<ReplayPass> ReplayProcesses::read_pass(const Child& child, int number) const {
  auto outputs = REHEARSE_TRY(Outputs::read(child.folder / fmt::format("{}.outputs", number)));
  ReplayPass pass;
  pass.outputs = std::move(outputs);
  const fs::path file = child.folder / fmt::format("{}.json", number);
  const auto text = read_text(file);
  if (!text) {  // the process ended before it wrote anything
    const auto& call = pass.outputs.unfinished();
    pass.failure = !child.killed ? sentence_of_death(child.status, call)
                   : call        ? fmt::format("controller '{}' hung in {}() at tick {}: its process had to be killed",
                                               call->controller, call->function, call->tick)
                                 : std::string("a controller's process didn't end, and had to be killed");
    return pass;
  }
  const Json report = Json::parse(*text, nullptr, false);
  try {
    if (!report.at("problem").is_null()) return report.at("problem").get<Diagnostic>();
    if (!report.at("failure").is_null()) pass.failure = report.at("failure").get<std::string>();
    pass.refused = report.at("refused");
    pass.counted_costs = report.at("counted_costs");
    for (const auto& [controller, faults] : report.at("page_faults").items())
      pass.page_faults[controller] = {"page_faults", faults.at(0), faults.at(1), faults.at(2)};
    pass.differs_from_recording = place_of_json(report.at("differs_from_recording"));
    pass.beyond = place_of_json(report.at("beyond"));
    if (!report.at("undefined").is_null()) pass.undefined = report.at("undefined");
    for (const Json& remark : report.at("remarks"))
      pass.remarks.push_back(remark.at("warning") ? warning(remark.at("text")) : error(remark.at("text")));
    if (report.contains("order")) {
      const auto& order = report.at("order");
      pass.order = {order.at("places"), order.at("threads"), exchanges_of_json(order)};
    }
    if (report.contains("executed")) pass.executed = executed_code_of_json(report.at("executed"));
  } catch (const Json::exception& wrong) {
    return error(fmt::format("{}: a replay's report can't be read: {}", file.string(), wrong.what()));
  }
  return pass;
}

Result<ReplayOutcome> ReplayProcesses::outcome(const Child& child) const {
  ReplayOutcome outcome;
  std::error_code ignored;
  if (!fs::exists(child.folder / "1.outputs", ignored)) {
    auto said = read_text(child.folder / "output.txt");
    while (said && said->ends_with('\n')) said->pop_back();
    return error(fmt::format("a process of the audit failed: {}", said ? *said : "it wrote no message"),
                 child.settings->valgrind != ValgrindTool::none ? "apt-get install valgrind" : "");
  }
  for (int number = 1; number <= child.settings->passes; ++number) {
    // The previous pass ended the process.
    if (!fs::exists(child.folder / fmt::format("{}.outputs", number), ignored)) break;
    auto pass = REHEARSE_TRY(read_pass(child, number));
    outcome.passes.push_back(std::move(pass));
  }
  if (child.settings->valgrind == ValgrindTool::callgrind) outcome.instruction_profile = profile_of(*child.settings);
  if (child.settings->valgrind == ValgrindTool::memcheck) {
    for (const auto& entry : fs::directory_iterator(child.folder, ignored))
      if (entry.path().extension() == ".xml")
        if (auto text = read_text(entry.path()); text && text->size() > outcome.valgrind_report.size())
          outcome.valgrind_report = *std::move(text);
  }
  if (child.settings->valgrind != ValgrindTool::none) return outcome;
  if (auto log = read_call_log(child.folder / "calls")) outcome.log = *std::move(log);
  return outcome;
}

}  // namespace rehearse
