#include "debugger.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/cdr.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/pin.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/clock.h"
#include "core/guard/child_process.h"
#include "core/host/controller_library.h"
#include "core/host/hosted_language.h"
#include "core/kinds/channel_name.h"
#include "core/mcap/whole_input.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/run_facts.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

Diagnostic no_gdb() { return error("there is no gdb on the PATH", "apt-get install gdb"); }

/// The tick and the controller at which gdb should stop.
struct Interesting {
  std::int64_t tick = 0;
  std::string controller;
  bool is_crash = false;  // then gdb stops where it crashes in that tick
};

/// Replays in a separate process, which may crash, and returns its result.
Interesting find_interesting(const Scenario& scenario, std::vector<std::string> words) {
  words.insert(words.begin(), own_program().string());
  words.push_back("--json");
  const auto output = output_of({std::move(words), environment_with({}), {}, ChildProcess::Errors::discarded});
  const Json report = Json::parse(output ? output->text : "", nullptr, false);
  if (!report.is_object()) return {};  // the run in gdb will report the error
  if (const auto failure = report.find("failure"); failure != report.end() && failure->is_string()) {
    const auto sentence = failure->get<std::string>();
    const bool is_crash = sentence.find(" crashed: ") != std::string::npos;
    fmt::print("{}: stopping {}\n", sentence, is_crash ? "there" : "at the beginning of that tick");
    return {report.value("ticks", std::int64_t{0}), {}, is_crash};
  }
  const auto first = report.find("first");
  if (first == report.end() || !first->is_object()) {
    fmt::print("its commands are the recorded ones: stopping at tick 0 (--tick N: at another)\n");
    return {};
  }
  Interesting found;
  found.tick = first->value("tick", std::int64_t{0});
  const std::string channel = first->value("channel", "");
  for (const NamedController& known : controllers_of(scenario))
    if (channel.starts_with("/" + known.label + "/")) found.controller = known.label;
  fmt::print("differs first from the recording at tick {} ({:g} s), in {} of {}: stopping there\n", found.tick,
             time_of(found.tick, scenario.time_step), first->value("element", ""), channel);
  return found;
}

/// The number of ticks of the recording in which controllers were called.
Result<std::int64_t> count_ticks(mcap::Reader& trace, std::size_t controllers) {
  std::vector<std::uint16_t> channels;
  for (const auto& [id, channel] : trace.channels())
    if (channel.topic == run_topics::tick) channels.push_back(id);
  if (channels.empty()) return error("it has no ticks: nothing of the run was recorded");
  std::int64_t ticks = 0;
  const auto count = [&](const mcap::Message& message) {
    CdrReader reader(message.data);
    msg::Tick tick;
    if (msg::decode(reader, tick) && tick.controller_results.size() == controllers) ++ticks;
    return true;
  };
  REHEARSE_TRY(trace.for_each_message(count, channels));
  return ticks;
}

/// Prints a line for each controller whose library differs from the recorded one.
Result<void> tell_other_libraries(const mcap::Reader& trace, const Scenario& scenario, const HostOptions& host) {
  const RunFacts recorded = RunFacts::of(trace);
  for (const NamedController& known : controllers_of(scenario)) {
    std::string library = known.controller->library;
    fs::path folder = folder_of(scenario);
    for (const auto& [name, other] : host.libraries)
      if (known.is_called(name)) {
        library = other;
        folder = fs::current_path();
      }
    const auto file = REHEARSE_TRY(find_controller_library(library, folder));
    if (recorded.controllers.contains(known.label) && !recorded.had_library(known.label, hash_of_controller(file)))
      fmt::print("{} is not the library that {} was recorded with\n", file.string(), known.label);
  }
  return {};
}

}  // namespace

Result<fs::path> find_gdb_script() {
  const fs::path script = program_tree() / "share/rehearse/gdb/rehearse_gdb.py";
  std::error_code ignored;
  if (fs::is_regular_file(script, ignored)) return script;
  return error(fmt::format("{} isn't there", script.string()), "it is built and installed together with rehearse");
}

std::vector<NamedController> controllers_of(const Scenario& scenario) {
  std::vector<NamedController> all;
  for (const ScenarioBody& body : scenario.bodies)
    for (const ScenarioController& controller : body.controllers) {
      all.push_back({body.name + "/" + controller.name, &controller});
      for (const ScenarioController& child : controller.children) all.push_back({body.name + "/" + child.name, &child});
    }
  return all;
}

Result<Scenario> scenario_for_gdb(const fs::path& trace) {
  if (find_program("gdb").empty()) return no_gdb();
  std::error_code ignored;
  if (fs::exists(trace, ignored) && !fs::is_regular_file(trace, ignored))
    return error(fmt::format("{} can be read only once, and gdb starts the replay anew", trace.string()),
                 "write it into a file");
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace));
  if (!reader->damage().empty()) return mcap::with_recover_hint(reader->damage());
  return scenario_of(*reader);
}

void add_debugger_options(CLI::App& options, DebuggerOptions& debugger) {
  options.add_flag("--gdb", debugger.gdb,
                   "in gdb, stopped in control() at --tick; --gdb=NAME: of that controller (NAME or BODY/NAME)");
  options
      .add_option("--gdb-arg", debugger.gdb_arguments, "a word for gdb, as --gdb-arg=-batch; or all of them behind --")
      ->type_name("WORD")
      ->allow_extra_args(false)
      ->needs("--gdb");
}

void spell_out_gdb_arguments(std::vector<std::string>& arguments) {
  const auto dashes = std::ranges::find(arguments, "--");
  const bool is_for_gdb = std::any_of(
      arguments.begin(), dashes, [](const std::string& word) { return word == "--gdb" || word.starts_with("--gdb="); });
  if (!is_for_gdb || dashes == arguments.end()) return;
  for (auto word = dashes + 1; word != arguments.end(); ++word) word->insert(0, "--gdb-arg=");
  arguments.erase(dashes);
}

std::vector<std::string> words_without(const std::vector<std::string_view>& left_out, std::string_view verb,
                                       const CLI::App& options) {
  std::vector<std::string> words{std::string(verb)}, positionals;
  for (const CLI::Option* option : options.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::ranges::find(left_out, name) != left_out.end()) continue;
    for (const std::string& result : option->results()) {
      if (option->get_positional())
        positionals.push_back(result);
      else
        words.push_back(option->get_items_expected_max() == 0 ? name : name + "=" + result);
    }
  }
  words.insert(words.end(), positionals.begin(), positionals.end());
  return words;
}

std::vector<std::string> words_without_debugger(std::string_view verb, const CLI::App& options) {
  return words_without({"--gdb", "--gdb-arg", "--tick"}, verb, options);
}

Result<void> check_debugger(const DebuggerOptions& debugger, const Scenario& scenario) {
  if (find_program("gdb").empty()) return no_gdb();
  const std::vector<NamedController> known = controllers_of(scenario);
  if (known.empty()) return error("--gdb stops in a controller, and this run has none");
  const std::string wanted = debugger.controller();
  const auto is_it = [&](const NamedController& controller) { return controller.is_called(wanted); };
  if (wanted.empty() || std::ranges::any_of(known, is_it)) return {};
  std::vector<std::string> names;
  for (const NamedController& controller : known) names.push_back(controller.label);
  return error(fmt::format("--gdb={}: the run has no controller of that name", wanted),
               fmt::format("controllers: {}", fmt::join(names, ", ")));
}

Result<void> check_tick(std::int64_t tick, std::int64_t ticks, double time_step) {
  if (tick < ticks) return {};
  return error(fmt::format("--tick {} is beyond the end: the run has {}, {:g} s", tick, count_text(ticks, "tick"),
                           time_of(ticks, time_step)),
               ticks > 0 ? fmt::format("expected 0 to {}", ticks - 1) : std::string());
}

Exit become_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words, std::int64_t tick,
                bool until_crash) {
  const fs::path gdb = find_program("gdb");
  const auto script = find_gdb_script();
  if (!script) return refuse(script.errors());
  std::vector<std::string> line{
      "gdb", "-q", "-x", script->string(), "-ex", fmt::format("rehearse-start {} {}", tick, debugger.controller())};
  if (until_crash) line.insert(line.end(), {"-ex", "continue"});
  line.insert(line.end(), debugger.gdb_arguments.begin(), debugger.gdb_arguments.end());
  line.insert(line.end(), {"--args", own_program().string()});
  line.insert(line.end(), words.begin(), words.end());
  std::fflush(stdout);
  replace_process(gdb, pointers_to(line).data(), {});
  return refuse(error(fmt::format("can't start {}: {}", gdb.string(), std::strerror(errno))));
}

Exit replay_in_gdb(DebuggerOptions debugger, const fs::path& trace, const HostOptions& host,
                   std::vector<std::string> words, std::optional<std::int64_t> tick) {
  const auto scenario = scenario_for_gdb(trace);
  if (!scenario) return refuse(scenario.errors());
  const auto reader = mcap::Reader::open(trace);
  if (!reader) return refuse(reader.errors());
  if (const auto able = check_debugger(debugger, *scenario); !able) return refuse(able.errors());
  const auto ticks = count_ticks(**reader, controllers_of(*scenario).size());
  if (!ticks) return refuse(ticks.errors());
  if (tick)
    if (const auto there = check_tick(*tick, *ticks, scenario->time_step); !there) return refuse(there.errors());
  if (const auto told = tell_other_libraries(**reader, *scenario, host); !told) return refuse(told.errors());
  bool until_crash = false;
  if (!tick) {
    const Interesting found = find_interesting(*scenario, words);
    tick = found.tick;
    until_crash = found.is_crash;
    if (debugger.controller().empty() && !found.controller.empty()) debugger.gdb = found.controller;
  }
  return become_gdb(debugger, words, *tick, until_crash);
}

Exit replay_log_in_gdb(const DebuggerOptions& debugger, const std::vector<std::string>& words,
                       std::optional<std::int64_t> tick) {
  if (find_program("gdb").empty()) return refuse(no_gdb());
  return become_gdb(debugger, words, tick.value_or(0));
}

}  // namespace rehearse::tool
