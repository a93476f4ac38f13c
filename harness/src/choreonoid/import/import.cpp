#include "import.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/text.h"
#include "project_run.h"

namespace rehearse::import {
namespace {

namespace fs = std::filesystem;

/// The folder that ${SHARE} stands for: the share folder of a checkout that contains the project, or of the
/// installation that contains it; empty: none was found.
fs::path find_share(const fs::path& project) {
  std::error_code ignored;
  const fs::path sample = fs::path("default") / "materials.yaml";
  for (fs::path above = fs::absolute(project, ignored).parent_path(); above.has_relative_path();
       above = above.parent_path())
    for (const fs::path& share : {above / "share", above})
      if (fs::exists(share / sample, ignored)) return share;
  return {};
}

/// Letters, digits and a few marks; others are not valid in a scenario's names.
std::string plain_name(const std::string& wanted) {
  std::string name;
  for (const char c : wanted)
    name += (c > ' ' && std::string_view("/*?[]:#{},&!|>'\"%@`\\\x7f").find(c) == std::string_view::npos) ? c : '_';
  constexpr std::size_t longest = 60;
  return name.empty() ? "Body" : name.substr(0, longest);
}

struct Reason {
  std::string_view ending;  // of the class
  std::string_view why;
  bool changes_the_run;
};

constexpr Reason reasons[] = {
    {"WorldItem", "another world of the project", false},
    {"MultiSE3MatrixSeqItem", "a recorded motion", false},
    {"SimulatorItem", "another simulator item is taken", false},
    {"SceneItem", "is drawn and has no contacts", false},
    {"LightingItem", "belongs to the display", false},
    {"CameraItem", "belongs to the display", false},
    {"VisualizerItem", "belongs to the display", false},
    {"Visualizer", "belongs to the display", false},
    {"FrameItem", "a frame for editing", false},
    {"FrameListItem", "a frame for editing", false},
    {"PoseSeqItem", "a motion for editing", false},
    {"SeqItem", "a recorded motion", false},
    {"LoggerItem", "a recording has contacts anyway", false},
    {"SubProjectItem", "a project within the project; import it by itself", true},
    {"SpringDamperContactItem", "contacts of springs and dampers aren't read", true},
    {"ControllerItem", "only SimpleControllers are run", true},
    {"ScriptItem", "scripts aren't run", true},
};

/// Of sub-simulators within the simulator item that is taken.
constexpr Reason reasons_of_sub_simulators[] = {
    {"MulticopterSimulatorItem", "the forces of rotors and of air aren't simulated", true},
    {"SubmersibleSimulatorItem", "the forces of water aren't simulated", true},
    {"SimulatorItem", "the effects of this plugin's simulator aren't simulated", true},
};

const Reason& reason_of(const std::string& type) {
  static constexpr Reason unknown{"", "its class is unknown", true};
  const auto found = std::ranges::find_if(reasons, [&](const Reason& reason) { return type.ends_with(reason.ending); });
  return found == std::end(reasons) ? unknown : *found;
}

}  // namespace

ProjectReader::ProjectReader(ProjectFile& file, fs::path project, const ImportOptions& options)
    : file_(file), project_(std::move(project)), options_(options) {
  if (options_.share.empty()) options_.share = find_share(project_);
}

std::string ProjectReader::seen_from_folder(const fs::path& file) const {
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(fs::absolute(options_.folder, ignored), ignored);
  return fs::weakly_canonical(fs::absolute(file, ignored), ignored).lexically_proximate(folder).string();
}

std::string ProjectReader::unique_name(const std::string& wanted, std::set<std::string>& names) const {
  const std::string base = plain_name(wanted);
  std::string name = base;
  for (int i = 2; !names.insert(name).second; ++i) name = fmt::format("{}_{}", base, i);
  return name;
}

void ProjectReader::leave_out(const ProjectItem& item, std::string_view why) {
  left_out(item, std::string(why));
  document().warning(*item.node, fmt::format("{} {} is left out: {}", item.type, in_quotes(item.name), why));
}

void ProjectReader::leave_out_sub_simulator(const ProjectItem& item) {
  if (settings_.simulator == nullptr || !item.is_below(*settings_.simulator))
    return left_out(item, "another simulator item is taken");
  if (!data_of(item, file_).flag({"enabled"}).value_or(true)) return left_out(item, "it is not enabled");
  leave_out(item, std::ranges::find_if(reasons_of_sub_simulators, [&](const Reason& reason) {
                    return item.type.ends_with(reason.ending);
                  })->why);
}

void ProjectReader::leave_out_the_rest() {
  for (const ProjectItem* item : file_.all()) {
    if (outcomes_.contains(item) || item->type == "FolderItem" || item->type == "RootItem" || item->type.empty())
      continue;
    if (item->is_sub_simulator()) {
      leave_out_sub_simulator(*item);
      continue;
    }
    const Reason& reason = reason_of(item->type);
    if (reason.changes_the_run)
      leave_out(*item, reason.why);
    else
      left_out(*item, std::string(reason.why));
  }
}

void ProjectReader::keep_model_options() {
  const UrdfOptions& model = options_.model;
  std::vector<std::string> packages;
  for (const auto& [name, directory] : model.packages)
    packages.push_back(fmt::format("{}: {}", yaml_text(name), yaml_text(seen_from_folder(directory))));
  if (!packages.empty()) settings_.model_options.push_back(fmt::format("packages: {{{}}}", fmt::join(packages, ", ")));
  if (model.allow_missing_meshes) settings_.model_options.emplace_back("allow_missing_meshes: true");
  if (model.allow_unknown_devices) settings_.model_options.emplace_back("allow_unknown_devices: true");
  if (model.mesh_z_up) settings_.model_options.emplace_back("mesh_up: z");
  if (model.default_mass) settings_.model_options.push_back(fmt::format("default_mass: {}", *model.default_mass));
}

Result<ImportedProject> ProjectReader::read() {
  const std::vector<const ProjectItem*> items = file_.all();
  choose_simulator();
  const ProjectItem* above = settings_.simulator == nullptr ? nullptr : settings_.simulator->above("WorldItem");
  const auto world = std::ranges::find_if(
      items, [&](const ProjectItem* item) { return item->type == "WorldItem" && (above == nullptr || item == above); });
  if (world == items.end()) {
    document().error(*file_.root.node, "the project has no WorldItem, so nothing is simulated",
                     "it may be a part of a project: Choreonoid loads several files into one project");
    return document().findings().errors();
  }
  world_ = *world;
  taken(*world_, "the scenario");
  read_settings();
  keep_model_options();
  read_materials();
  read_bodies();
  if (bodies_.empty() && !document().findings().has_error())
    document().error(*world_->node, "no BodyItem is below the world, so nothing is simulated");
  read_vision();
  leave_out_the_rest();
  if (document().findings().has_error()) {
    Diagnostics all = document().findings().errors();
    all.insert(all.end(), model_errors_.begin(), model_errors_.end());
    return all;
  }
  ImportedProject imported;
  imported.name = plain_name(project_.stem().string());
  imported.scenario =
      scenario_text(imported.name, project_.filename().string(), settings_, materials_, bodies_, attachments_);
  imported.files = std::move(files_);
  for (const ProjectItem* item : items) {
    const auto outcome = outcomes_.find(item);
    if (outcome != outcomes_.end())
      imported.items.push_back(
          {item->type, item->name, outcome->second.is_taken, outcome->second.text, item->node->line});
  }
  document().tell_passed();
  imported.remarks = document().findings().report();
  return imported;
}

}  // namespace rehearse::import

namespace rehearse {
namespace {

using import::ProjectFile;
using import::ProjectItem;

/// A file of several that are one project.
struct LoadedFile {
  std::filesystem::path path;
  std::unique_ptr<ProjectFile> file;
};

bool has(const ProjectFile& file, const auto& test) {
  return std::ranges::any_of(file.all(), [&](const ProjectItem* item) { return test(*item); });
}

bool has_world(const ProjectFile& file) {
  return has(file, [](const ProjectItem& item) { return item.type == "WorldItem"; });
}

/// Index of the file with the world; 0 if none has one.
std::size_t find_world(const std::vector<LoadedFile>& files, const std::string& simulator) {
  const auto runs = [&](const LoadedFile& loaded) {
    return has_world(*loaded.file) && (simulator.empty() || has(*loaded.file, [&](const ProjectItem& item) {
                                         return item.is_simulator() && item.name == simulator;
                                       }));
  };
  auto found = std::ranges::find_if(files, runs);
  if (found == files.end()) found = std::ranges::find_if(files, [](const auto& each) { return has_world(*each.file); });
  return found == files.end() ? 0 : static_cast<std::size_t>(found - files.begin());
}

/// The items of a file that has no part in the run.
void add_outside(const LoadedFile& outside, const std::string& world, ImportedProject& imported) {
  const std::string name = outside.path.filename().string();
  ProjectFile& file = *outside.file;
  for (const auto& item : file.root.children) {
    imported.items.push_back({item->type, item->name, false,
                              fmt::format("of {}, outside of the world of {}", name, world), item->node->line});
    if (item->type == "WorldItem" || item->type == "BodyItem")
      file.document.warning(*item->node, fmt::format("{} {} is outside of the world of {}, so it isn't simulated",
                                                     item->type, in_quotes(item->name), world));
  }
  const Diagnostics remarks = file.document.findings().report();
  imported.remarks.insert(imported.remarks.end(), remarks.begin(), remarks.end());
}

}  // namespace

Result<ImportedProject> import_project_text(const std::string& text, const std::filesystem::path& project,
                                            const ImportOptions& options) {
  const auto file = import::read_project_file(text, project.string());
  if (file->document.findings().has_error()) return file->document.findings().errors();
  return import::ProjectReader(*file, project, options).read();
}

Result<ImportedProject> import_projects(const std::vector<std::filesystem::path>& projects,
                                        const ImportOptions& options) {
  std::vector<LoadedFile> files;
  for (const std::filesystem::path& project : projects) {
    const std::string text = REHEARSE_TRY(read_yaml_file(project, "a Choreonoid project"));
    files.push_back({project, import::read_project_file(text, project.string())});
    if (files.back().file->document.findings().has_error()) return files.back().file->document.findings().errors();
  }
  const std::size_t world = find_world(files, options.simulator);
  const auto last =
      std::ranges::find_if(files.rbegin(), files.rend(), [](const auto& each) { return each.file->has_time_bar; });
  if (last != files.rend() && last->file != files[world].file) files[world].file->take_time_bar(*last->file);
  auto imported = REHEARSE_TRY(import::ProjectReader(*files[world].file, files[world].path, options).read());
  for (std::size_t i = 0; i < files.size(); ++i)
    if (i != world) add_outside(files[i], files[world].path.filename().string(), imported);
  return imported;
}

Result<ImportedProject> import_project(const std::filesystem::path& project, const ImportOptions& options) {
  return import_projects({project}, options);
}

}  // namespace rehearse
