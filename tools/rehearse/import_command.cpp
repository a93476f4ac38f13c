// rehearse import: writes the scenario that a Choreonoid project runs.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "import/import.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct ImportSettings {
  std::string project;
  std::string folder;
  std::string share;
  ImportOptions options;
  bool json = false;
};

/// Writes the files; those that are there may have been changed by hand.
Result<void> write_all(const fs::path& folder, const ImportedProject& imported) {
  std::map<std::string, std::string> files = imported.files;
  files[imported.name + ".yaml"] = imported.scenario;
  std::error_code problem;
  for (const auto& [name, text] : files)
    if (fs::exists(folder / name, problem))
      return error_in((folder / name).string(), "it exists, and may have been changed by hand",
                      "name another folder, or remove it");
  fs::create_directories(folder, problem);
  if (problem) return error_in(folder.string(), "the folder can't be made: " + problem.message());
  for (const auto& [name, text] : files)
    if (auto done = write_text(folder / name, text); !done) return done;
  return {};
}

/// Items of one class with one outcome share a row.
void print_items(const std::vector<ImportedItem>& items, bool is_taken, const std::string& heading) {
  std::vector<TableRow> rows{{heading, "item", is_taken ? "became" : "why"}};
  std::map<std::pair<std::string, std::string>, std::size_t> known;
  for (const ImportedItem& item : items) {
    if (item.is_taken != is_taken) continue;
    const auto [row, is_new] = known.emplace(std::pair(item.type, item.outcome), rows.size());
    if (is_new || is_taken)
      rows.push_back({item.type, plain_text(item.name), plain_text(item.outcome)});
    else
      rows[row->second][1] += ", " + plain_text(item.name);
  }
  if (rows.size() > 1) print_table(rows);
}

/// `errors`: the reasons why the scenario doesn't load.
Json json_of_import(const ImportedProject& imported, const std::string& scenario, const Diagnostics& errors) {
  Json items = Json::array();
  for (const ImportedItem& item : imported.items)
    items.push_back({{"class", item.type},
                     {"name", item.name},
                     {"line", item.line},
                     {"taken", item.is_taken},
                     {"outcome", item.outcome}});
  return {{"scenario", scenario}, {"items", items}, {"remarks", json_of(imported.remarks)}, {"errors", json_of(errors)}};
}

Exit run_import(ImportSettings& settings) {
  settings.options.folder = settings.folder;
  settings.options.share = settings.share;
  const auto imported = import_project(settings.project, settings.options);
  if (!imported) return refuse(imported.errors());
  if (const auto written = write_all(settings.folder, *imported); !written) return refuse(written.errors());
  const std::string file = (fs::path(settings.folder) / (imported->name + ".yaml")).string();
  // A valid project may result in a scenario that has to be completed by hand.
  const auto scenario = Scenario::load(file);
  const Diagnostics errors = scenario ? Diagnostics() : scenario.errors();
  if (settings.json) {
    print(json_of_import(*imported, file, errors));
  } else {
    print_items(imported->items, true, "taken");
    fmt::print("\n");
    print_items(imported->items, false, "left out");
    if (scenario)
      fmt::print("\nwrote {}; run it with: rehearse record {}\n", file, file);
    else
      fmt::print("\nwrote {}, which can't be run before its errors are mended\n", file);
  }
  std::fflush(stdout);  // before related output on stderr
  fmt::print(stderr, "{}", to_string(imported->remarks));
  fmt::print(stderr, "{}", to_string(errors));
  return scenario ? Exit::done : Exit::differs;
}

std::function<Exit()> declare_import(CLI::App& options) {
  const auto settings = std::make_shared<ImportSettings>();
  options.add_option("PROJECT", settings->project, "a project of Choreonoid, *.cnoid")->required()->type_name("");
  options.add_option("-o,--output", settings->folder, "the folder for the scenario, PROJECT.yaml (this one)")
      ->type_name("DIR")
      ->default_val(".");
  options
      .add_option("--simulator", settings->options.simulator,
                  "the simulator item to take, by its name (the first of ODE, else the first)")
      ->type_name("NAME");
  add_number(options, "--duration", "simulated time [s], instead of the project's", 0.0, Scenario::max_duration,
             [=](double duration) { settings->options.duration = duration; });
  options
      .add_option("--share", settings->share,
                  "the folder for ${SHARE} (the share folder of the checkout or installation around the project)")
      ->type_name("DIR");
  add_json_flag(options, settings->json);
  return [settings] { return run_import(*settings); };
}

}  // namespace

const Verb import_verb{"import",
                       "  rehearse import choreonoid/sample/SimpleController/SR1Walk.cnoid -o walk\n"
                       "  rehearse record walk/SR1Walk.yaml --controller SR1WalkController=build/SR1WalkPattern.so\n"
                       "\n"
                       "Bodies, poses, controllers, settings of the simulator and materials are taken. Models and "
                       "controllers stay where they are.\n"
                       "Exit status 1: the scenario is written, but can't be run before its errors are mended.\n",
                       declare_import};

}  // namespace rehearse::tool
