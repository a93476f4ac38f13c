// rehearse import: writes the scenario that a Choreonoid project runs.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "choreonoid/import/import.h"
#include "command.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

struct ImportSettings {
  std::vector<std::string> projects;  // files of one
  std::string folder;
  std::string share;
  std::vector<std::string> search;
  ImportOptions options;
  bool json = false;
  bool force = false;
};

/// Files that are written, and their folder. Removed again when this goes out of scope, unless they are kept; files
/// that were replaced then have their text again.
class WrittenFiles {
 public:
  WrittenFiles(fs::path folder, bool replaces) : folder_(std::move(folder)), replaces_(replaces) {}
  ~WrittenFiles() {
    std::error_code ignored;
    for (const auto& [path, earlier] : replaced_) fs::rename(earlier, path, ignored);
    for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, ignored);  // only empty folders
  }
  WrittenFiles(const WrittenFiles&) = delete;
  WrittenFiles& operator=(const WrittenFiles&) = delete;

  /// Files that are there may have been changed by hand: then nothing is written, unless they are to be replaced.
  Result<void> write(const std::map<std::string, std::string>& files) {
    std::error_code problem;
    for (const auto& [name, text] : files)
      if (!replaces_ && fs::exists(folder_ / name, problem))
        return error_in((folder_ / name).string(), "it exists, and may have been changed by hand",
                        "name another folder, remove it, or replace it with --force");
    REHEARSE_TRY(make_folder(fs::absolute(folder_, problem).lexically_normal()));
    for (const auto& [name, text] : files) {
      const fs::path path = fs::absolute(folder_ / name, problem);
      if (fs::exists(path, problem)) {
        const fs::path earlier = path.string() + ".earlier";
        fs::rename(path, earlier, problem);
        if (problem) return error_in(path.string(), "it can't be replaced: " + problem.message());
        replaced_.emplace_back(path, earlier);
      } else {
        made_.push_back(path);
      }
      REHEARSE_TRY(write_text(folder_ / name, text));
    }
    return {};
  }
  void keep() {
    std::error_code ignored;
    for (const auto& [path, earlier] : replaced_) fs::remove(earlier, ignored);
    replaced_.clear();
    made_.clear();
  }

 private:
  Result<void> make_folder(const fs::path& folder) {
    std::error_code problem;
    if (folder.empty() || fs::is_directory(folder, problem)) return {};
    if (folder.has_relative_path()) REHEARSE_TRY(make_folder(folder.parent_path()));
    if (!fs::create_directory(folder, problem) && problem)
      return error_in(folder_.string(), "the folder can't be made: " + problem.message());
    if (folder.has_filename()) made_.push_back(folder);
    return {};
  }

  fs::path folder_;
  bool replaces_;
  std::vector<fs::path> made_;                           // in order, folders before their content
  std::vector<std::pair<fs::path, fs::path>> replaced_;  // and where the earlier ones are meanwhile
};

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

Json json_of_import(const ImportedProject& imported, const std::string& scenario) {
  Json items = Json::array();
  for (const ImportedItem& item : imported.items)
    items.push_back({{"class", item.type},
                     {"name", item.name},
                     {"line", item.line},
                     {"taken", item.is_taken},
                     {"outcome", item.outcome}});
  return {{"scenario", scenario}, {"items", items}, {"remarks", tool::json_of(imported.remarks)}};
}

/// A project without mistakes may result in a scenario with mistakes: a missing mesh is one. `file`: was not written.
Diagnostics why_unusable(const std::string& project, const std::string& file, const Diagnostics& mistakes) {
  Diagnostics all{error_in(project, fmt::format("nothing was written: {} would have these mistakes", file))};
  all.insert(all.end(), mistakes.begin(), mistakes.end());
  return all;
}

Exit run_import(ImportSettings& settings) {
  settings.options.folder = settings.folder;
  settings.options.share = settings.share;
  for (const std::string& folder : settings.search) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) return refuse(error_in(folder, "the folder of --search isn't there"));
    settings.options.search.emplace_back(folder);
  }
  auto imported = import_projects({settings.projects.begin(), settings.projects.end()}, settings.options);
  if (!imported) return refuse(imported.errors());
  const std::string file = (fs::path(settings.folder) / (imported->name + ".yaml")).string();
  std::map<std::string, std::string> files = imported->files;
  files[imported->name + ".yaml"] = imported->scenario;
  WrittenFiles written(settings.folder, settings.force);
  if (const auto done = written.write(files); !done) return refuse(done.errors());
  const auto scenario = Scenario::load(file);
  if (!scenario) return refuse(why_unusable(settings.projects.front(), file, scenario.errors()));
  written.keep();
  const UrdfOptions& model = settings.options.model;
  if (model.allow_missing_meshes || model.allow_unknown_devices)  // which ones are left out
    imported->remarks.insert(imported->remarks.end(), scenario->warnings.begin(), scenario->warnings.end());
  if (settings.json) {
    print(json_of_import(*imported, file));
  } else {
    print_items(imported->items, true, "taken");
    fmt::print("\n");
    print_items(imported->items, false, "left out");
    fmt::print("\nwrote {}; run it with: rehearse record {}\n", file, file);
  }
  std::fflush(stdout);  // before related output on stderr
  fmt::print(stderr, "{}", to_string(imported->remarks));
  const bool is_odd = std::ranges::any_of(
      imported->remarks, [](const Diagnostic& remark) { return remark.severity == Severity::warning; });
  return is_odd ? Exit::odd : Exit::done;
}

std::function<Exit()> declare_import(CLI::App& options) {
  const auto settings = std::make_shared<ImportSettings>();
  options
      .add_option("PROJECT", settings->projects,
                  "a project of Choreonoid, *.cnoid; or its files, of which one has the world")
      ->required()
      ->type_name("");
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
  options
      .add_option("--search", settings->search,
                  "a folder in which files that aren't there are searched by the ends of their paths; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  add_model_options(options, settings->options.model);
  options.add_flag("--force", settings->force, "replace the files of an earlier import");
  add_json_flag(options, settings->json);
  return [settings] { return run_import(*settings); };
}

}  // namespace

extern const Verb import_verb{
    "import",
    "  rehearse import choreonoid/sample/SimpleController/SR1Walk.cnoid -o walk\n"
    "  rehearse record walk/SR1Walk.yaml --controller SR1WalkController=build/SR1WalkPattern.so\n"
    "\n"
    "Bodies, poses, controllers, settings of the simulator and materials are taken. Models and "
    "controllers stay where they are.\n"
    "\n"
    "Exit status: 0 the scenario is written; 4 it is written, and a warning says what of the run is\n"
    "left out or replaced; 2 the project or its scenario has mistakes, and nothing is written.\n",
    declare_import};

}  // namespace rehearse::tool
