// The simulator item's settings, the cameras that a vision simulator runs, and the tables of materials.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/names.h"
#include "base/text.h"
#include "project_run.h"

namespace rehearse::import {
namespace {

using body::Mapping;

constexpr const char* ode = "ODESimulatorItem";
constexpr const char* aist = "AISTSimulatorItem";
constexpr const char* bullet = "BulletSimulatorItem";
constexpr const char* agx = "AGXSimulatorItem";
constexpr const char* kinematic = "KinematicSimulatorItem";
constexpr const char* gl_vision = "GLVisionSimulatorItem";
constexpr const char* vfx_vision = "VFXVisionSimulatorItem";
constexpr double longest_until_done = 60.0;  // [s], where a project leaves the end to its controllers
constexpr double endless = 10.0;             // [s], where a project runs until somebody stops it

/// Of every simulator item: for the display, for the recording and for speed.
const std::vector<std::string_view> item_keys_without_effect{"realtime_sync",
                                                             "realtime_sync_mode",
                                                             "realtimeSync",
                                                             "recording",
                                                             "recordingMode",
                                                             "record_collision_data",
                                                             "recordCollisionData",
                                                             "output_all_link_positions",
                                                             "allLinkPositionOutputMode",
                                                             "output_device_states",
                                                             "deviceStateOutput",
                                                             "use_controller_threads",
                                                             "controllerThreads",
                                                             "block_scene_view_edit_mode",
                                                             "scene_view_edit_mode_blocking",
                                                             "num_collision_detection_threads",
                                                             "time_sync_items",
                                                             "collisionSeqItem"};

/// Words of a list, or one word.
std::vector<std::string> words_of(const YamlNode& node) {
  std::vector<std::string> words;
  if (node.kind == YamlNode::Kind::scalar) words.push_back(node.text);
  for (const YamlNodePtr& item : node.items) words.push_back(item->text);
  return words;
}

}  // namespace

void ProjectReader::choose_simulator() {
  std::vector<const ProjectItem*> simulators;
  std::vector<std::string> names;
  for (const ProjectItem* item : file_.all()) {
    if (!item->is_simulator()) continue;
    simulators.push_back(item);
    names.push_back(item->name);
  }
  const auto wanted = [&](const auto& test) {
    const auto found = std::ranges::find_if(simulators, test);
    return found == simulators.end() ? nullptr : *found;
  };
  if (!options_.simulator.empty()) {
    settings_.simulator = wanted([&](const ProjectItem* item) { return item->name == options_.simulator; });
    if (settings_.simulator == nullptr)
      document().error(*file_.root.node,
                       fmt::format("the project has no simulator item {}", in_quotes(options_.simulator)),
                       name_hint(options_.simulator, names, "simulator items"));
    return;
  }
  settings_.simulator = wanted([](const ProjectItem* item) { return item->type == ode; });
  if (settings_.simulator == nullptr && !simulators.empty()) settings_.simulator = simulators.front();
}

void ProjectReader::read_settings() {
  settings_.time_step = 1.0 / file_.frame_rate;
  if (settings_.simulator == nullptr) {
    settings_.duration = options_.duration ? *options_.duration : length_of_time_bar();
    settings_.why_so_long = options_.duration ? "" : "as in the time bar";
    if (options_.simulator.empty())
      document().warning(*world_->node, "the project has no simulator item; step and length are those of the time bar",
                         "--duration S changes the length");
    return;
  }
  const ProjectItem& item = *settings_.simulator;
  Mapping keys = data_of(item, file_);
  const auto rate = keys.number({"frame_rate", "frameRate", "framerate"});
  if (rate && *rate > 0.0) settings_.time_step = 1.0 / *rate;
  settings_.time_step = keys.number({"time_step", "timeStep", "timestep"}).value_or(settings_.time_step);
  settings_.options = keys.text({"controller_options", "controllerOptions"}).value_or("");
  if (settings_.time_step < 1e-5 || settings_.time_step > 0.1)
    document().error(*item.node, fmt::format("the time step is {} s", settings_.time_step),
                     "a scenario's is from 0.00001 to 0.1 s");
  read_time_range(keys);
  const auto gravity = keys.vector({"gravity", "Gravity"});
  if (gravity && !gravity->isApprox(Eigen::Vector3d(0.0, 0.0, -9.80665), 1e-12)) settings_.gravity = gravity;
  settings_.is_planar = keys.flag({"use_2d_mode", "2Dmode"}).value_or(false);
  settings_.is_kinematic = item.type == kinematic;
  settings_.obeys_collision_switch = item.type == aist || item.type == agx;
  settings_.initial_commands = item.type != ode && item.type != bullet;  // which set commands back
  if (item.type == ode) read_ode(keys);
  if (item.type == aist) read_aist(keys);
  tell_item(item);
  keys.finish(item_keys_without_effect);
  taken(item, fmt::format("time step {} s, {}", settings_.time_step,
                          item.type == ode ? "gravity, solver, options" : "gravity, options"));
}

void ProjectReader::tell_item(const ProjectItem& item) {
  if (item.type != ode && !settings_.is_kinematic)
    document().warning(
        *item.node,
        fmt::format("{} {} is simulated with ODE's contacts and the direct solver here: forces differ from its own",
                    item.type, in_quotes(item.name)));
}

double ProjectReader::length_of_time_bar() {
  if (file_.wrong_time_bar != nullptr)
    document().error(*file_.wrong_time_bar, "the time bar has no positive frame_rate and max_time",
                     "--duration S states the length");
  return file_.max_time;
}

void ProjectReader::read_time_range(Mapping& keys) {
  const std::string mode = keys.text({"time_range_mode", "timeRangeMode"}).value_or("unlimited");
  const double length = keys.number({"time_length", "timeLength"}).value_or(300.0);
  settings_.ends_when_done =
      keys.flag({"is_active_control_time_range_mode", "active_control_time_range_mode", "isActiveControlTimeRangeMode"})
          .value_or(false) ||
      mode == "Active control period" || mode == "Active control time";
  if (options_.duration) {
    settings_.duration = *options_.duration;
  } else if (mode == "specified" || mode == "Specified time") {
    settings_.duration = length;
  } else if (mode == "timebar" || mode == "Time bar range" || mode == "TimeBar range") {
    settings_.duration = length_of_time_bar();
  } else if (settings_.ends_when_done) {
    settings_.duration = longest_until_done;
    settings_.why_so_long = "at most: the project leaves it to its controllers";
  } else {
    settings_.duration = endless;
    settings_.why_so_long = "the project runs until somebody stops it";
    document().warning(keys.node(), fmt::format("the project has no end; the scenario has {} s", endless),
                       "--duration S changes the length");
  }
  if (settings_.duration <= 0.0 || settings_.duration > 86400.0)
    document().error(keys.node(), fmt::format("the run lasts {} s", settings_.duration),
                     "a scenario's duration is above 0 and at most 86400 s");
}

/// The method of the ODE item, and its keys whose values differ from the defaults, which scenarios share. A project of
/// another item has the default method: Choreonoid's own engine solves joints directly, too.
void ProjectReader::read_ode(Mapping& keys) {
  settings_.limits = {.efforts = false, .drives = false};
  const auto state = [this](const char* key, const std::optional<double>& value, double otherwise) {
    if (value && *value != otherwise) settings_.solver.emplace_back(key, fmt::format("{}", *value));
  };
  const bool is_exact = keys.text({"step_mode", "stepMode"}).value_or("").starts_with("Big");
  settings_.solver.emplace_back("method", is_exact ? "exact" : "quick");
  state("iterations", keys.number({"num_iterations", "numIterations"}), 50.0);
  state("over_relaxation", keys.number({"over_relaxation", "overRelaxation"}), 1.3);
  state("erp", keys.number({"global_erp", "globalERP"}), 0.4);
  state("cfm", keys.number({"global_cfm", "globalCFM"}), 1e-10);
  const auto velocity = keys.number({"max_correcting_velocity", "maxCorrectingVel"});
  const bool is_limited = keys.flag({"limit_correcting_velocity", "limitCorrectingVel"}).value_or(true);
  state("max_correcting_velocity", is_limited ? velocity : std::optional(1e6), 0.01);
  settings_.friction = keys.number({"friction"}).value_or(1.0);
  settings_.joint_limits = keys.flag({"enable_joint_limit", "jointLimitMode"}).value_or(false);
  const bool has_rotors = keys.flag({"add_joint_axis_inertia_to_link_inertia"}).value_or(false);
  if (has_rotors)
    document().note(keys.node(), "rotors resist the acceleration of their joints; their inertia isn't added to links");
  if (keys.flag({"use_world_collision_detector", "useWorldCollisionDetector", "UseWorldItem'sCollisionDetector"})
          .value_or(false))
    document().warning(keys.node(), "contacts are found by ODE, not by the world's collision detector");
  settings_.belt_depth = keys.number({"surface_drive_culling_depth"}).value_or(settings_.belt_depth);
}

/// The keys of the AIST item. It drives joints to their commands in the step, and clamps commanded efforts. Those of
/// its solver have no counterpart, and change forces only if they aren't the usual ones.
void ProjectReader::read_aist(Mapping& keys) {
  settings_.limits = {.efforts = true, .drives = false};
  settings_.is_kinematic = keys.text({"dynamics_mode", "dynamicsMode"}).value_or("") == "Kinematics";
  const double least = keys.number({"min_friction_coefficient"}).value_or(0.0);
  const double most = keys.number({"max_friction_coefficient"}).value_or(100.0);
  settings_.friction_range = {std::min(least, most), most};
  std::vector<std::string> without;
  const auto compare = [&without](const char* name, const std::optional<double>& value, double usual) {
    if (value.value_or(usual) != usual) without.emplace_back(name);
  };
  compare("contact_culling_distance", keys.number({"contact_culling_distance", "cullingThresh"}), 0.005);
  compare("contact_culling_depth", keys.number({"contact_culling_depth", "contactCullingDepth"}), 0.05);
  compare("error_criterion", keys.number({"error_criterion", "errorCriterion"}), 1e-3);
  compare("max_num_iterations", keys.number({"max_num_iterations", "maxNumIterations"}), 10.0);
  compare("max_num_contact_points", keys.number({"max_num_contact_points"}), 4.0);
  compare("contact_correction_depth", keys.number({"contact_correction_depth", "contactCorrectionDepth"}), 0.00025);
  compare("contact_correction_velocity_ratio",
          keys.number({"contact_correction_velocity_ratio", "contactCorrectionVelocityRatio"}), 5.0);
  if (keys.text({"integration_mode", "integrationMode"}).value_or("").starts_with("runge"))
    without.emplace_back("integration_mode");
  if (keys.flag({"enable_kinematic_walking", "kinematicWalking"}).value_or(false))
    without.emplace_back("enable_kinematic_walking");
  if (keys.flag({"use_old_accel_sensor_mode", "oldAccelSensorMode"}).value_or(false))
    without.emplace_back("use_old_accel_sensor_mode");
  if (!without.empty())
    document().warning(keys.node(),
                       fmt::format("{} {} no counterpart here, and Choreonoid's run uses {}", fmt::join(without, ", "),
                                   without.size() == 1 ? "has" : "have", without.size() == 1 ? "it" : "them"));
}

/// Notes the names of a vision simulator that no body or camera has.
void ProjectReader::note_unknown_targets(const ProjectItem& item, const std::vector<std::string>& bodies,
                                         const std::vector<std::string>& sensors) {
  for (const std::string& name : bodies)
    if (std::ranges::none_of(bodies_, [&](const ProjectBody& body) { return body.item->name == name; }))
      document().note(*item.node, fmt::format("{} is for the body {}, which isn't there", item.type, in_quotes(name)));
  const auto has_sensor = [&](const std::string& name) {
    for (const ProjectBody& body : bodies_)
      for (const Device& device : body.model.devices)
        if (device.name == name) return true;
    return false;
  };
  for (const std::string& name : sensors)
    if (!has_sensor(name))
      document().note(*item.node,
                      fmt::format("{} is for the sensor {}, which isn't there", item.type, in_quotes(name)));
}

void ProjectReader::read_vision() {
  if (settings_.simulator == nullptr) return;
  bool takes_all = false;
  for (const ProjectItem* item : file_.all()) {
    if ((item->type != gl_vision && item->type != vfx_vision) || !item->is_below(*settings_.simulator)) continue;
    Mapping keys = data_of(*item, file_);
    if (!keys.flag({"enabled"}).value_or(true)) {
      left_out(*item, "it is not enabled");
      continue;
    }
    std::vector<std::string> bodies, sensors;
    if (const YamlNode* node = keys.find({"target_bodies", "targetBodies"})) bodies = words_of(*node);
    if (const YamlNode* node = keys.find({"target_sensors", "targetSensors"})) sensors = words_of(*node);
    settings_.has_vision = true;
    if (!settings_.cameras) settings_.cameras.emplace();
    const auto is_meant = [](const std::vector<std::string>& words, const std::string& name) {
      return words.empty() || std::ranges::find(words, name) != words.end();
    };
    for (const ProjectBody& body : bodies_)
      for (const Device& device : body.model.devices)
        if (std::holds_alternative<Camera>(device.kind) && is_meant(bodies, body.item->name) &&
            is_meant(sensors, device.name))
          settings_.cameras->push_back(body.name + "/" + device.name);
    note_unknown_targets(*item, bodies, sensors);
    takes_all = takes_all || (bodies.empty() && sensors.empty());
    if (item->type != gl_vision)
      document().warning(*item->node, fmt::format("{} {} takes pictures, and its effects aren't drawn here", item->type,
                                                  in_quotes(item->name)));
    keys.finish();
    taken(*item, "the cameras take pictures");
  }
  if (takes_all) settings_.cameras.reset();
}

void ProjectReader::read_materials() {
  Mapping keys = data_of(*world_, file_);
  const YamlNode* file = keys.find({"default_material_table_file", "materialTableFile"});
  read_table(file == nullptr ? "${SHARE}/default/materials.yaml" : file->text, file == nullptr ? *world_->node : *file);
  keys.finish();
  for (const ProjectItem* item : file_.all()) {
    if (item->type != "MaterialTableItem" || !item->is_below(*world_)) continue;
    Mapping table = data_of(*item, file_);
    const YamlNode* name = table.find({"file"});
    if (name == nullptr) {
      document().error(*item->node, fmt::format("the {} {} names no file", item->type, in_quotes(item->name)));
      continue;
    }
    read_table(name->text, *name);
    table.finish();
    taken(*item, fmt::format("materials of {}", std::filesystem::path(name->text).filename().string()));
  }
}

void ProjectReader::read_table(const std::string& written, const YamlNode& at) {
  const bool is_default = written == "${SHARE}/default/materials.yaml";
  if (is_default && options_.share.empty()) {
    document().warning(at, "Choreonoid's own table of materials isn't found: friction is 0.5 everywhere",
                       "--share DIR: Choreonoid's share folder, which has default/materials.yaml");
    materials_.add_default_pair();
    return;
  }
  const auto path = find_file(written, at);
  if (!path) return;
  const auto text = read_yaml_file(*path, "a table of materials");
  const auto root = text ? parse_yaml_document(*text, path->string()) : Result<YamlDocument>(text.errors());
  if (!root) {
    document().error(at, fmt::format("the table of materials {} can't be used: {}", in_quotes(written),
                                     root.errors().front().message));
    return;
  }
  body::Document table(path->string(), false);
  materials_.read(*root->root, table);
  for (const Diagnostic& mistake : table.findings().errors()) model_errors_.push_back(mistake);
  if (table.findings().has_error())
    document().error(at, fmt::format("the table of materials {} can't be used", in_quotes(written)));
}

}  // namespace rehearse::import
