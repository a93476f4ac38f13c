// A Choreonoid project (.cnoid) as a scenario.
//
// What decides the run is taken: the bodies below the world with their initial poses and postures, their
// SimpleControllers, the settings of one simulator item, contact materials, and the length of the run. Each item of the
// project has an outcome: what it became, or why it is left out. Models and controllers stay where they are; the
// scenario names them.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct ImportOptions {
  std::filesystem::path folder;    // of the scenario: paths in it are relative to it
  std::string simulator;           // name of the simulator item; empty: the first of ODE, else the first
  std::optional<double> duration;  // [s], instead of the project's
  std::filesystem::path share;     // what ${SHARE} stands for; empty: searched for above the project
};

/// An item of the project.
struct ImportedItem {
  std::string type;  // its class: "BodyItem"
  std::string name;
  bool is_taken = false;
  std::string outcome;  // "body SR1: SR1.body, 29 joints"; of an item that is left out, why
  int line = 0;
};

struct ImportedProject {
  std::string name;                          // of the scenario: its file is NAME.yaml
  std::string scenario;                      // its text
  std::map<std::string, std::string> files;  // others to write beside it, by name: models around meshes
  std::vector<ImportedItem> items;           // in document order; folders are left out
  Diagnostics remarks;                       // warnings and notes, in document order
};

/// Reads the project, and the models and tables of materials that it names. On failure: its mistakes, each with its
/// place; a model that can't be used is one of them, followed by the model's own mistakes.
Result<ImportedProject> import_project(const std::filesystem::path& project, const ImportOptions& options);

/// The same for text that is already in memory; `project` is its name in messages, and what paths are relative to.
Result<ImportedProject> import_project_text(const std::string& text, const std::filesystem::path& project,
                                            const ImportOptions& options);

}  // namespace rehearse
