// A Choreonoid project (.cnoid) as a scenario.
//
// The scenario gets everything that decides the run: the bodies below the world with their initial poses, postures and
// SimpleControllers, the settings of one simulator item, contact materials, the run's length. Each item of the project
// has an outcome: its use in the scenario, or the reason why it is left out. Models and controllers stay in their
// places; the scenario names them.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/urdf.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct ImportOptions {
  std::filesystem::path folder;               // of the scenario: paths in it are relative to it
  std::string simulator;                      // name of the simulator item; empty: the first of ODE, else the first
  std::optional<double> duration;             // [s], instead of the project's
  std::filesystem::path share;                // value of ${SHARE}; empty: searched for above the project
  std::vector<std::filesystem::path> search;  // folders in which files that aren't there are searched first
  UrdfOptions model;  // of all models: packages (values of variables in paths, too), missing meshes, unknown devices
                      // and a default mass are used
};

/// An item of the project.
struct ImportedItem {
  std::string type;  // its class: "BodyItem"
  std::string name;
  bool is_taken = false;
  std::string outcome;  // "body SR1: SR1.body, 29 joints"; or the reason why the item is left out
  int line = 0;
};

struct ImportedProject {
  std::string name;                          // of the scenario: its file is NAME.yaml
  std::string scenario;                      // its text
  std::map<std::string, std::string> files;  // other files to write beside it, by name: models around meshes
  std::vector<ImportedItem> items;           // in document order; folders are left out
  Diagnostics remarks;                       // warnings and notes, in document order
};

/// Reads the files as one project: as Choreonoid, which adds the items of each to one tree, and takes the time bar of
/// the last one that has it. The world is that of the first file that has one, with the simulator item that is asked
/// for; all else of the other files is outside of it.
Result<ImportedProject> import_projects(const std::vector<std::filesystem::path>& projects,
                                        const ImportOptions& options);

/// Reads the project, and the models and tables of materials that it names. On failure: its mistakes, each with its
/// place; a model that can't be used is one of them, followed by the model's own mistakes.
Result<ImportedProject> import_project(const std::filesystem::path& project, const ImportOptions& options);

/// As import_project() for text in memory; `project` is its name in messages, and paths are relative to its folder.
Result<ImportedProject> import_project_text(const std::string& text, const std::filesystem::path& project,
                                            const ImportOptions& options);

}  // namespace rehearse
