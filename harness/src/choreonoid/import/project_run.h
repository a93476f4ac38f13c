// The run of a project, before it is written as a scenario.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "contact_materials.h"
#include "import.h"
#include "project_file.h"

namespace rehearse::import {

struct ProjectController {
  std::string name;     // unique within its body
  std::string library;  // as the scenario names it
  std::string options;
  bool delay = true;
  std::vector<ProjectController> children;
};

/// An initial displacement that a scenario has to state.
struct Posture {
  std::string joint;
  std::string value;  // "-30 deg", "0.02"
};

struct ProjectBody {
  const ProjectItem* item = nullptr;
  std::string name;        // unique
  std::string model_file;  // as the scenario names it
  Model model;             // without meshes
  bool fixed = false;
  bool is_fixed_by_model = false;
  bool self_collision = false;
  bool touches = true;             // the project's switch; counts for some simulator items
  bool has_effort_limits = false;  // a joint of it has a limit of its effort
  bool has_drive_limits = false;   // a joint of it has a limit of its effort or velocity
  bool has_limits = false;         // a joint of it has a limit of its displacement
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::vector<Posture> posture;
  std::vector<ProjectController> controllers;
};

/// A body that is attached to another.
struct Attachment {
  std::string parent;  // "Stand/LINK" or "Stand"
  std::string child;   // name of a body
};

/// The limits of joints that a simulator item applies.
struct ItemLimits {
  bool efforts = false;  // commanded efforts are clamped
  bool drives = true;    // drives of displacement and velocity keep to the limits of effort and velocity
};

/// The settings of the simulator item, or of the time bar.
struct ProjectSettings {
  const ProjectItem* simulator = nullptr;  // null: the project has none
  double time_step = 0.001;                // [s]
  double duration = 0.0;                   // [s]
  std::string why_so_long;                 // reason of the duration, for a comment
  bool ends_when_done = false;
  std::string options;
  std::vector<std::string> model_options;                   // keys of each body, as they are written
  std::vector<std::pair<std::string, std::string>> solver;  // keys of a scenario's solver, as they are written
  std::optional<Eigen::Vector3d> gravity;                   // [m/s²]; nullopt: the usual one
  double friction = 1.0;                                    // of the simulator item: friction of belts
  double belt_depth = 0.005;                                // belts don't drive deeper contacts [m]; 0: they do
  bool joint_limits = false;
  bool is_planar = false;
  bool is_kinematic = false;
  ItemLimits limits;
  bool obeys_collision_switch = false;  // of body items
  bool initial_commands = false;        // what controllers write in initialize() acts in the first step
  std::optional<std::pair<double, double>> friction_range;  // to which the item clamps friction
  std::optional<std::vector<std::string>> cameras;          // patterns of names in vision simulators
  bool has_vision = false;
};

/// Reads a project step by step.
class ProjectReader {
 public:
  ProjectReader(ProjectFile& file, std::filesystem::path project, const ImportOptions& options);

  Result<ImportedProject> read();

 private:
  // project_settings.cpp
  void choose_simulator();
  void read_settings();
  void read_time_range(body::Mapping& keys);
  double length_of_time_bar();
  void read_ode(body::Mapping& keys);
  void read_aist(body::Mapping& keys);
  void tell_item(const ProjectItem& item);
  void read_vision();
  void note_unknown_targets(const ProjectItem& item, const std::vector<std::string>& bodies,
                            const std::vector<std::string>& sensors);
  void read_materials();
  void read_table(const std::string& written, const YamlNode& at);

  // project_bodies.cpp
  void read_bodies();
  void read_body(const ProjectItem& item);
  void read_model(body::Mapping& keys, ProjectBody& body);
  void wrap_mesh(const std::filesystem::path& mesh, ProjectBody& body);
  void read_pose(body::Mapping& keys, ProjectBody& body);
  void read_posture(body::Mapping& keys, ProjectBody& body);
  void read_root(body::Mapping& keys, ProjectBody& body);
  void attach(const ProjectItem& item, body::Mapping& keys, ProjectBody& body);

  // project_controllers.cpp
  void read_controllers(const ProjectItem& item, std::set<std::string>& names,
                        std::vector<ProjectController>& controllers);
  std::optional<ProjectController> read_controller(const ProjectItem& item, std::set<std::string>& names);
  std::string library_of(const ProjectItem& item, const std::string& written, const std::string& base);
  std::string seen_as_library(const std::filesystem::path& file) const;

  // project_files.cpp
  /// A path as the project writes it, with the value of the variable at its beginning; relative ones are in the
  /// project's folder. None: the variable is unknown.
  std::optional<std::filesystem::path> expanded(const std::string& written) const;
  /// The file that the project names. A missing one is taken from a similar place in the project's folders, with a
  /// warning; an unknown variable in its path is reported.
  std::optional<std::filesystem::path> find_file(const std::string& written, const YamlNode& at);
  /// The value of a variable in paths.
  std::optional<std::filesystem::path> folder_of(const std::string& variable) const;
  std::optional<std::filesystem::path> find_similar(const std::string& written) const;

  // import.cpp
  std::string seen_from_folder(const std::filesystem::path& file) const;
  std::string unique_name(const std::string& wanted, std::set<std::string>& names) const;
  void taken(const ProjectItem& item, std::string outcome) { outcomes_[&item] = {true, std::move(outcome)}; }
  void left_out(const ProjectItem& item, std::string why) { outcomes_[&item] = {false, std::move(why)}; }
  void keep_model_options();
  void leave_out_the_rest();
  void leave_out(const ProjectItem& item, std::string_view why);
  void leave_out_sub_simulator(const ProjectItem& item);
  body::Document& document() { return file_.document; }

  ProjectFile& file_;
  std::filesystem::path project_;
  ImportOptions options_;
  const ProjectItem* world_ = nullptr;
  ProjectSettings settings_;
  ContactMaterials materials_;
  std::vector<ProjectBody> bodies_;
  std::vector<Attachment> attachments_;
  std::set<std::string> body_names_;
  std::map<std::string, std::string> files_;
  struct Outcome {
    bool is_taken;
    std::string text;
  };
  std::map<const ProjectItem*, Outcome> outcomes_;
  Diagnostics model_errors_;  // of models that can't be used
};

/// The text of the scenario.
std::string scenario_text(const std::string& name, const std::string& project, const ProjectSettings& settings,
                          const ContactMaterials& materials, const std::vector<ProjectBody>& bodies,
                          const std::vector<Attachment>& attachments);

}  // namespace rehearse::import
