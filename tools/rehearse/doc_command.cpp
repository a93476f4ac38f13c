// rehearse doc: opens the site that was installed with the command, or prints the pages that it is made of. It also
// prints the JSON Schemas.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

#include "command.h"
#include "core/form/form_schema.h"
#include "core/form/form_table.h"
#include "output.h"
#include "progress.h"
#include "schemas.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct Topic {
  std::string_view name;
  std::string_view page;  // path in the folders of the manual and of the site, without its ending
  std::string_view summary;
};

constexpr std::string_view scripts_topic = "scripts";

constexpr Topic topics[] = {
    {"start", "learn/first_golden", "the way from nothing to a first verdict"},
    {"command", "reference/verbs", "the verbs, beside their options, and projects"},
    {"expressions", "reference/expressions", "how topics, times, series and ticks are selected"},
    {"exit", "reference/exit", "exit statuses, output files"},
    {"json", "reference/json", "the fields of --json"},
    {"environment", "reference/environment", "variables of the environment"},
    {"scenarios", "reference/scenario", "the YAML file of a run"},
    {"bodies", "reference/bodies", "bodies, ground, joints and welds of a scenario"},
    {"inputs", "reference/inputs", "controllers, pushes and the joystick of a scenario"},
    {"noise", "reference/noise", "noise of sensors"},
    {"tolerances", "reference/tolerances", "how far a channel may be from the golden"},
    {"expectations", "reference/expectations", "what every run must do, and the horizon"},
    {"variations", "reference/variations", "varied parameters of campaigns"},
    {"urdf", "reference/urdf", "robot models: what is accepted, repaired, refused"},
    {"body", "reference/body", "Choreonoid's models"},
    {"meshes", "reference/meshes", "mesh files, and where they are searched"},
    {"devices", "reference/devices", "sensors, cameras and lights of a model"},
    {"import", "reference/import", "projects of Choreonoid as scenarios"},
    {"logs", "reference/logs", "the forms of a robot's log"},
    {"maps", "reference/map", "from the topics of a log to the inputs of a controller"},
    {"ticks", "reference/log_ticks", "ticks and clocks of a log"},
    {"controllers", "reference/cnoid", "the API of controllers, member by member"},
    {"calls", "concepts/controller", "when the functions of a controller are called"},
    {"samples", "reference/samples", "controllers to begin with"},
    {"traces", "reference/trace_format", "the content of a trace file"},
    {"verdicts", "concepts/comparisons", "the three comparisons, and the part to blame"},
    {"proof", "concepts/proof", "why most checks need no simulation"},
    {"goldens", "concepts/goldens", "goldens: review, acceptance, parts of a run"},
    {"horizon", "concepts/noise", "the noise of a scenario, and its horizon"},
    {"audits", "concepts/audit", "is a controller a function of its inputs?"},
    {"campaigns", "concepts/campaigns", "many variations of a scenario"},
    {"physics", "concepts/physics", "links, drives, joints and the solver"},
    {"contacts", "concepts/contacts", "contacts and friction"},
    {"sensors", "concepts/sensors", "the formulas of sensors"},
    {scripts_topic, "howto/scripts", "for scripts and language models: record, check, explain, fix"},
    {"red", "howto/red_test", "from a red test to the line at fault"},
    {"step", "howto/red_test", "a run tick by tick; a part of the same page"},
    {"gdb", "howto/red_test", "a controller in gdb, forwards and backwards; a part of the same page"},
    {"what_if", "howto/what_if", "altered inputs, branches of a recording"},
    {"bags", "howto/ros2_bag", "a ROS 2 bag into a controller"},
    {"terms", "concepts/terms", "golden, trace, tick, level, horizon, ..."},
};

/// The folder of the manual's pages, in the build folder or installed.
fs::path manual() { return program_tree() / "share/doc/rehearse"; }

/// The site: installed beside the manual, or built by tools/docs in the build folder; empty if there is none.
fs::path site() {
  for (const fs::path& folder : {manual() / "site", program_tree() / "docs"})
    if (std::error_code ignored; fs::exists(folder / "index.html", ignored)) return folder;
  return {};
}

/// Replaces this process by the desktop's browser, if there is a desktop. Returns if there is none.
void open_in_browser(const fs::path& page) {
  const auto is_set = [](const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0';
  };
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) return;
  fmt::print("file://{}\n", page.string());
  std::fflush(stdout);
  execlp("xdg-open", "xdg-open", page.c_str(), nullptr);
}

Exit list_topics() {
  for (const Topic& topic : topics) fmt::print("{:<13}{}\n", topic.name, topic.summary);
  fmt::print("\nThe pages: {}\n", manual().string());
  if (const fs::path pages = site(); !pages.empty())
    fmt::print("In a browser: file://{}\n", (pages / "index.html").string());
  return Exit::done;
}

/// The table of the keys of a form: "scenario.solver" is the form "solver" in the schema "scenario".
Result<std::string> table_of_keys(const std::string& name) {
  const std::size_t dot = name.find('.');
  const std::string schema = name.substr(0, dot), form = dot == std::string::npos ? schema : name.substr(dot + 1);
  for (const NamedForm& each : all_schemas())
    if (const Form* found = each.name == schema ? find_form(each.type, form) : nullptr) return table_text(*found);
  return error(fmt::format("there is no form '{}'", name), "expected SCHEMA.FORM, as scenario.solver");
}

Exit print_keys(const std::string& name) {
  const Result<std::string> table = table_of_keys(name);
  if (!table) return refuse(table.errors());
  fmt::print("{}", *table);
  return Exit::done;
}

/// The page with a table in the place of each line `<<made: keys SCHEMA.FORM>>`.
std::string with_tables(const std::string& page) {
  constexpr std::string_view begin = "<<made: keys ", end = ">>";
  std::string text;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    const bool is_made = line.starts_with(begin) && line.ends_with(end);
    const auto table = is_made ? table_of_keys(line.substr(begin.size(), line.size() - begin.size() - end.size()))
                               : Result<std::string>(line + '\n');
    text += table ? *table : to_string(table.errors());
  }
  return text;
}

/// Shows a text in the user's pager. False: there is none.
bool in_pager(const std::string& text) {
  const char* pager = std::getenv("PAGER");
  FILE* const to = popen(pager && *pager ? pager : "less", "w");
  if (!to) return false;
  std::fputs(text.c_str(), to);
  constexpr int no_such_program = 127 << 8;  // as the shell states it
  return pclose(to) != no_such_program;
}

/// The text of a topic's page.
Result<std::string> text_of(const Topic& topic) {
  const fs::path page = manual() / (std::string(topic.page) + ".md");
  std::ifstream stream(page, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream && !text.str().empty()) return with_tables(text.str());
  return error(fmt::format("can't read {}", page.string()), "the manual is installed with the command");
}

Exit show(const std::string& name, bool as_text) {
  const auto topic = std::ranges::find_if(topics, [&](const Topic& t) { return t.name == name; });
  if (topic == std::end(topics))
    return refuse(error(fmt::format("there is no topic '{}'", name), "rehearse doc lists the topics"));
  if (const fs::path pages = site(); !as_text && is_terminal(stdout) && !pages.empty())
    open_in_browser(pages / (std::string(topic->page) + ".html"));
  const auto text = text_of(*topic);
  if (!text) return refuse(text.errors());
  if (!is_terminal(stdout) || !in_pager(*text)) fmt::print("{}", *text);
  return Exit::done;
}

/// Prints the page for scripts as it is.
Exit print_for_scripts() {
  const auto text = text_of(*std::ranges::find(topics, scripts_topic, &Topic::name));
  if (!text) return refuse(text.errors());
  fmt::print("{}", *text);
  return Exit::done;
}

/// Prints the JSON Schema of that name.
Exit print_schema(const std::string& name) {
  std::string names;
  for (const NamedForm& schema : all_schemas()) {
    if (schema.name == name) {
      fmt::print("{}", schema_text(schema.title, schema.type));
      return Exit::done;
    }
    names += fmt::format("{}{}", names.empty() ? "" : ", ", schema.name);
  }
  return refuse(error(fmt::format("there is no schema '{}'", name), "there are " + names));
}

/// Writes all JSON Schemas into a folder, each as NAME.json.
Exit write_schemas(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) return refuse(error_in(folder.string(), fmt::format("it can't be made: {}", problem.message())));
  for (const NamedForm& schema : all_schemas()) {
    const fs::path file = folder / fmt::format("{}.json", schema.name);
    if (const auto written = write_text(file, schema_text(schema.title, schema.type)); !written)
      return refuse(written.errors());
  }
  return Exit::done;
}

struct DocSettings {
  std::string topic, schema, schemas, keys;
  bool as_text = false, for_scripts = false;
};

std::function<Exit()> declare_doc(CLI::App& options) {
  const auto settings = std::make_shared<DocSettings>();
  CLI::Option* topic =
      options.add_option("TOPIC", settings->topic, "the page to show; without one, topics are listed")->type_name("");
  options.add_flag("--text", settings->as_text, "as text, at the terminal, also if a browser can show the page");
  options
      .add_flag("--llms", settings->for_scripts,
                "print what scripts and language models have to know, in two screens; llms.txt of the site")
      ->excludes(topic);
  options
      .add_option("--schema", settings->schema,
                  "print the JSON Schema of a file (scenario, map) or of a verb's --json (check, golden-list)")
      ->type_name("NAME")
      ->excludes(topic);
  options
      .add_option("--keys", settings->keys,
                  "print the keys of a map in a file, with texts, values and defaults, as --keys scenario.solver")
      ->type_name("NAME")
      ->excludes(topic);
  options.add_option("--schemas", settings->schemas, "write all JSON Schemas into a folder, each as NAME.json")
      ->type_name("DIR")
      ->excludes(topic);
  return [settings] {
    if (settings->for_scripts) return print_for_scripts();
    if (!settings->schema.empty()) return print_schema(settings->schema);
    if (!settings->keys.empty()) return print_keys(settings->keys);
    if (!settings->schemas.empty()) return write_schemas(settings->schemas);
    return settings->topic.empty() ? list_topics() : show(settings->topic, settings->as_text);
  };
}

}  // namespace

extern const Verb doc_verb{"doc",
                           "  rehearse doc\n  rehearse doc scenarios\n  rehearse doc scenarios --text\n  rehearse doc "
                           "--schema scenario > scenario.json\n",
                           declare_doc};

}  // namespace rehearse::tool
