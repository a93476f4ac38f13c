#include "lockstep.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/mcap.h>
#include <rehearse/pin.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "commit_build.h"
#include "core/guard/child_process.h"
#include "core/host/controller_library.h"
#include "core/host/hosted_language.h"
#include "core/trace/run_facts.h"
#include "debugger.h"
#include "output.h"
#include "scratch_folder.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_changes = 8;

/// The two libraries of one controller.
struct Pair {
  std::string controller;  // BODY/NAME
  fs::path old_library, new_library;
  std::string old_name;                               // for messages: the word of the user
  std::optional<ScratchFolder> built = std::nullopt;  // both libraries, if the old one is that of a commit
};

/// The result of a replay with one library, without a debugger.
struct Replayed {
  std::int64_t ticks = 0;
  std::optional<std::int64_t> differs_from;  // the first tick whose commands aren't the recorded ones, or that failed
  std::string failure;
};

Result<NamedController> find_controller(const Scenario& scenario, const HostOptions& host, const std::string& name) {
  const std::vector<NamedController> all = controllers_of(scenario);
  std::vector<NamedController> found;
  for (const NamedController& known : all) {
    const auto is_given = [&](const auto& entry) { return known.is_called(entry.first); };
    if (name.empty() ? std::ranges::any_of(host.libraries, is_given) : known.is_called(name)) found.push_back(known);
  }
  if (name.empty() && host.libraries.empty()) found = all;
  if (found.size() == 1) return found.front();
  std::vector<std::string> names;
  for (const NamedController& known : all) names.push_back(known.label);
  return error(name.empty() ? "--beside: which controller is meant?"
                            : fmt::format("--beside {}=...: the run has no controller of that name", name),
               fmt::format("expected NAME=OLD; controllers: {}", fmt::join(names, ", ")));
}

Result<fs::path> recorded_library(const fs::path& trace, const NamedController& controller, const fs::path& present) {
  const auto reader = REHEARSE_TRY(mcap::Reader::open(trace));
  if (RunFacts::of(*reader).had_library(controller.label, hash_of_controller(present))) return present;
  return error(fmt::format("{} isn't the library that was recorded", present.string()),
               "name a copy of the old library, or the commit that it was built from");
}

Result<void> check_language(const fs::path& library) {
  const auto hosted = hosted_name(library);
  if (!hosted) return {};
  return error(fmt::format("--beside compares controllers in C++, and {} is in {}", library.filename().string(),
                           hosted->language.name),
               "replay --tick and --watch show commands beside the recorded ones");
}

Result<Pair> pair_of(const fs::path& trace, const Scenario& scenario, const std::string& beside,
                     const HostOptions& host) {
  const std::size_t sign = beside.find('=');
  const std::string name = sign == std::string::npos ? "" : beside.substr(0, sign);
  Pair pair;
  pair.old_name = sign == std::string::npos ? beside : beside.substr(sign + 1);
  const auto controller = REHEARSE_TRY(find_controller(scenario, host, name));
  pair.controller = controller.label;
  const auto present = find_controller_library(controller.controller->library, folder_of(scenario));
  const auto given =
      std::ranges::find_if(host.libraries, [&](const auto& entry) { return controller.is_called(entry.first); });
  pair.new_library = REHEARSE_TRY(
      given == host.libraries.end() ? present : find_controller_library(given->second, fs::current_path()));
  REHEARSE_TRY(check_language(pair.new_library));
  if (pair.old_name == "recorded") {
    if (!present) return present.errors();
    pair.old_library = REHEARSE_TRY(recorded_library(trace, controller, *present));
    return pair;
  }
  const auto old = find_controller_library(pair.old_name, fs::current_path());
  if (old) {
    pair.old_library = *old;
    REHEARSE_TRY(check_language(*old));
    return pair;
  }
  if (!is_commit(pair.old_name)) {
    Diagnostic problem = old.errors().front();
    problem.message += "; and git knows no commit of that name in the working folder";
    return problem;
  }
  pair.built.emplace(ScratchFolder::temporary());
  pair.old_library = REHEARSE_TRY(build_of_commit(pair.old_name, pair.new_library, pair.built->path()));
  if (given != host.libraries.end()) return pair;
  pair.new_library = REHEARSE_TRY(build_of_sources(pair.new_library, pair.built->path()));
  return pair;
}

/// The arguments of a replay with that library.
std::vector<std::string> words_of(const Pair& pair, const fs::path& library, const HostOptions& host,
                                  const CLI::App& options) {
  std::vector<std::string> words = words_without({"--beside", "--json", "--controller"}, "replay", options);
  const std::string name = pair.controller.substr(pair.controller.find('/') + 1);
  for (const auto& [other, file] : host.libraries)
    if (other != name && other != pair.controller) words.push_back(fmt::format("--controller={}={}", other, file));
  words.push_back(fmt::format("--controller={}={}", pair.controller, library.string()));
  return words;
}

Result<Replayed> replay_alone(std::vector<std::string> words) {
  words.insert(words.begin(), own_program().string());
  words.push_back("--json");
  const auto output =
      REHEARSE_TRY(output_of({std::move(words), environment_with({}), {}, ChildProcess::Errors::discarded}));
  const Json report = Json::parse(output.text, nullptr, false);
  if (!report.is_object()) return error("the replay failed", "rehearse replay without --beside says why");
  Replayed replayed;
  replayed.ticks = report.value("ticks", std::int64_t{0});
  if (report.at("failure").is_string()) {
    replayed.failure = report["failure"].get<std::string>();
    replayed.differs_from = replayed.ticks;
  }
  if (report.at("first").is_object()) replayed.differs_from = report["first"].value("tick", std::int64_t{0});
  return replayed;
}

/// Until the first tick whose commands differ between the two, if the replays show it.
Json request_of(const Pair& pair, const Replayed& old, const Replayed& present) {
  const bool differs = old.differs_from != present.differs_from;
  constexpr std::int64_t never = std::int64_t{1} << 62;
  const std::int64_t first = std::min(old.differs_from.value_or(never), present.differs_from.value_or(never));
  return {{"controller", pair.controller},
          {"until", differs ? first : std::max(old.ticks, present.ticks)},
          {"differs", differs}};
}

Result<Json> run_gdb(const Json& request) {
  const auto script = REHEARSE_TRY(find_gdb_script());
  const ScratchFolder folder = ScratchFolder::temporary();
  if (folder.path().empty()) return error("no folder for temporary files can be created");
  const fs::path asked = folder.path() / "request.json", found = folder.path() / "result.json";
  REHEARSE_TRY(write_text(asked, request.dump()));
  std::vector<std::string> words{find_program("gdb").string(),
                                 "-q",
                                 "-nx",
                                 "-batch",
                                 "-x",
                                 script.string(),
                                 "-ex",
                                 fmt::format("rehearse-lockstep {} {}", asked.string(), found.string()),
                                 own_program().string()};
  const auto output = REHEARSE_TRY(output_of({std::move(words), environment_with({}), {}}));
  std::ifstream stream(found);
  Json result = Json::parse(stream, nullptr, false);
  if (!result.is_object()) return error("gdb failed: " + output.text, "a container needs --cap-add=SYS_PTRACE for gdb");
  if (result.contains("failure")) return error(result["failure"].get<std::string>());
  return result;
}

bool is_found(const Json& result, const char* key) { return result.contains(key) && !result[key].is_null(); }

std::string place_text(const Json& place) {
  return fmt::format("{}:{}", fs::path(place.value("file", "")).filename().string(), place.value("line", 0));
}

/// "Walker::control()", without the parameters, and without namespaces that have no name.
std::string function_text(const Json& place) {
  std::string name = place.value("function", "");
  constexpr std::string_view unnamed = "(anonymous namespace)::";
  for (std::size_t at = name.find(unnamed); at != std::string::npos; at = name.find(unnamed))
    name.erase(at, unnamed.size());
  return name.substr(0, name.find('(')) + "()";
}

std::string change_text(const Json& number) {
  return fmt::format("{} is {}, not {}", number.value("name", ""), number.value("new", ""), number.value("old", ""));
}

/// "gain_ is 8, not 80, and 2 more numbers".
std::string changes_text(const Json& numbers) {
  const std::int64_t more = static_cast<std::int64_t>(numbers.size()) - 1;
  return change_text(numbers[0]) +
         (more > 0 ? fmt::format(", and {} differ{}", count_text(more, "more number"), more == 1 ? "s" : "") : "");
}

std::string difference_in_tick(const Json& result, double time_step) {
  const std::int64_t tick = result["tick"].get<std::int64_t>();
  const std::string when = fmt::format("tick {} ({:g} s)", tick, time_of(tick, time_step));
  const Json values = result.value("values", Json::array());
  if (!values.empty() && is_found(result, "new"))
    return fmt::format("at {}, after {} in {}: {}", when, place_text(result["new"]), function_text(result["new"]),
                       changes_text(values));
  if (!values.empty() && is_found(result, "old"))
    return fmt::format("at {}: {}; the old one writes it in {}, and the new one doesn't", when, changes_text(values),
                       place_text(result["old"]));
  if (!values.empty()) return fmt::format("at {}, already where control() begins: {}", when, changes_text(values));
  if (is_found(result, "new") || is_found(result, "new_next")) {
    const auto next = [&](const char* key) { return is_found(result, key) ? place_text(result[key]) : "the end"; };
    return fmt::format("at {}: they go different ways from {} on, to {}, and the old one to {}", when,
                       is_found(result, "new") ? place_text(result["new"]) : "the beginning", next("new_next"),
                       next("old_next"));
  }
  const std::string after =
      result.value("after", Json::array()).empty() ? "its commands differ" : changes_text(result["after"]);
  if (result.contains("too_long"))
    return fmt::format("at {}: {}; control() executes more than {} lines there, so the line isn't known", when, after,
                       result["too_long"].get<std::int64_t>());
  return fmt::format("at {}: {}; no line of the controllers' own sources shows it", when, after);
}

std::string verdict_of(const Pair& pair, const Json& result, double time_step) {
  const std::string compared = fmt::format("{} of its object before {}", count_text(result["numbers"], "number"),
                                           count_text(result["ticks"], "tick"));
  const bool before = !result["before"].empty();
  if (result["ticks"] == 0) return fmt::format("nothing was compared: {} was called in no tick", pair.controller);
  if (!before && !result.contains("tick"))
    return fmt::format("{} is equal with both libraries: its commands, and {}", pair.controller, compared);
  std::string text = pair.controller + " differs first ";
  if (before) text += "before the run: " + changes_text(result["before"]);
  if (before && result.contains("tick")) text += "; then ";
  if (result.contains("tick")) text += difference_in_tick(result, time_step);
  return text;
}

std::string source_line(const Json& place) {
  const std::size_t at = static_cast<std::size_t>(place.value("line", 0) - place.value("begin", 0));
  const auto lines = place.value("source", std::vector<std::string>());
  if (at >= lines.size()) return {};
  const std::size_t begin = lines[at].find_first_not_of(" \t");
  return begin == std::string::npos ? std::string() : lines[at].substr(begin);
}

void tell(const Pair& pair, const Json& result, double time_step) {
  fmt::print("{}\n", verdict_of(pair, result, time_step));
  const auto show = [](const char* which, const Json& place, bool with_source) {
    fmt::print("  {}  {}  {}\n", which, place_text(place),
               with_source ? plain_text(source_line(place)) : std::string());
  };
  if (is_found(result, "new")) show("new", result["new"], true);
  // an old source of the same path has been overwritten
  if (is_found(result, "old"))
    show("old", result["old"],
         !is_found(result, "new") || result["old"].value("file", "") != result["new"].value("file", ""));
  std::vector<TableRow> rows{{"  number", "new", "old"}};
  for (const char* key : {"before", "values"})
    for (const Json& number : result.value(key, Json::array()))
      if (rows.size() <= most_changes)
        rows.push_back({"  " + number.value("name", ""), number.value("new", ""), number.value("old", "")});
  if (rows.size() > 2) print_table(rows);
  const auto lines = result.contains("lines")
                         ? fmt::format(", and {} of that tick", count_text(result["lines"], "executed line"))
                         : std::string();
  fmt::print("compared: {} of its object before {}{}\n", count_text(result["numbers"], "number"),
             count_text(result["ticks"], "tick"), lines);
  for (const auto& [key, which] : {std::pair("only_new", "new"), std::pair("only_old", "old")})
    if (const auto names = result.value(key, std::vector<std::string>()); !names.empty())
      fmt::print("only in the {} one: {}\n", which, fmt::join(names, ", "));
}

Diagnostics remarks_on(const Pair& pair, const Replayed& old, const Replayed& present, const Json& result) {
  Diagnostics remarks;
  if (old.differs_from)
    remarks.push_back(warning(fmt::format("{} isn't the recorded controller: its commands differ from tick {} on",
                                          pair.old_name, *old.differs_from)));
  for (const auto& [replayed, which] : {std::pair(&old, "old"), std::pair(&present, "new")})
    if (!replayed->failure.empty())
      remarks.push_back(warning(fmt::format("the {} one fails: {}", which, replayed->failure)));
  if (result.value("is_optimised", false))
    remarks.push_back(warning("the library is optimised: the line is the last that wrote the number in that tick",
                              "with both built with -O0 it is the first line in which a variable differs"));
  if (!result.value("is_complete", true))
    remarks.push_back(warning("its object has too many numbers: the first 20000 are compared"));
  return remarks;
}

}  // namespace

Exit replay_beside(const fs::path& trace, const std::string& beside, const HostOptions& host, bool json,
                   const CLI::App& options) {
  const auto scenario = scenario_for_gdb(trace);
  if (!scenario) return refuse(scenario.errors());
  const auto pair = pair_of(trace, *scenario, beside, host);
  if (!pair) return refuse(pair.errors());
  const std::vector<std::string> old_words = words_of(*pair, pair->old_library, host, options);
  const std::vector<std::string> new_words = words_of(*pair, pair->new_library, host, options);
  const auto old = replay_alone(old_words);
  if (!old) return refuse(old.errors());
  const auto present = replay_alone(new_words);
  if (!present) return refuse(present.errors());
  Json request = request_of(*pair, *old, *present);
  request["old"] = old_words;
  request["new"] = new_words;
  auto result = run_gdb(request);
  if (!result) return refuse(result.errors());
  const Diagnostics remarks = remarks_on(*pair, *old, *present, *result);
  const bool is_equal = (*result)["before"].empty() && !result->contains("tick");
  if (json) {
    Json object{{"verdict", verdict_of(*pair, *result, scenario->time_step)},
                {"equal", is_equal},
                {"controller", pair->controller}};
    for (const char* key : {"before", "tick", "values", "new", "old", "new_next", "old_next", "numbers", "ticks",
                            "lines", "only_new", "only_old"})
      object[key] = result->contains(key) ? (*result)[key] : Json(nullptr);
    object["remarks"] = json_of_remarks(remarks, {});
    print(object);
  } else {
    tell(*pair, *result, scenario->time_step);
    std::fflush(stdout);  // before related output on stderr
    tell_remarks(remarks, std::nullopt);
  }
  if ((*result)["ticks"] == 0) return Exit::bad_input;
  return is_equal ? Exit::done : Exit::differs;
}

}  // namespace rehearse::tool
