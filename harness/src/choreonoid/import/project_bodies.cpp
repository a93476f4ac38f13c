// The bodies below the world, with their poses, postures and controllers.
#include <rehearse/body.h>
#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "project_run.h"

namespace rehearse::import {
namespace {

using body::Mapping;
namespace fs = std::filesystem;

constexpr double least = 1e-12;  // smaller displacements and angles are zero

/// The link that a joint with Choreonoid's index moves. Joints with an id come first, then all others in the order of
/// links, including the joints of free links.
int link_of_joint(const Model& model, int index) {
  std::map<int, int> by_id;
  std::vector<int> others;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Joint& joint = model.links[i].joint;
    const int id = joint.controller_id.value_or(has_id(joint.type) ? joint.id : -1);
    if (id >= 0)
      by_id.emplace(id, static_cast<int>(i));
    else if (i > 0 && joint.type != JointType::fixed)
      others.push_back(static_cast<int>(i));
  }
  const int identified = by_id.empty() ? 0 : by_id.rbegin()->first + 1;
  if (index < identified) return by_id.contains(index) ? by_id.at(index) : -1;
  const auto place = static_cast<std::size_t>(index - identified);
  return place < others.size() ? others[place] : -1;
}

/// The displacement as a scenario states it; in a project it is in degrees for sliders, too.
std::string value_text(const Joint& joint, double value, bool in_degrees) {
  if (std::abs(value) < least) return "0";
  if (is_linear(joint.type)) return fmt::format("{}", in_degrees ? value * std::numbers::pi / 180.0 : value);
  return in_degrees ? fmt::format("{} deg", value) : fmt::format("{}", value);
}

template <class Test>
bool any_joint(const Model& model, const Test& test) {
  return std::ranges::any_of(model.links,
                             [&](const Link& link) { return is_movable(link.joint.type) && test(link.joint); });
}

bool is_limited(const Joint& joint) { return std::isfinite(joint.lower) || std::isfinite(joint.upper); }
bool has_effort_limit(const Joint& joint) { return std::isfinite(joint.effort); }
bool has_drive_limit(const Joint& joint) { return has_effort_limit(joint) || std::isfinite(joint.velocity); }

/// Of a body item: for the display and for editing. The first two count for some simulator items.
const std::vector<std::string_view> body_keys_without_effect{"collision_detection", "collisionDetection",
                                                             "current_base_link",   "currentBaseLink",
                                                             "enable_joint_limits", "isSceneBodyDraggable",
                                                             "lock_location",       "location_editable",
                                                             "isEditable",          "scene_sensitive",
                                                             "transparency",        "visible_link_selection_mode",
                                                             "link_kinematics",     "zmp"};

}  // namespace

void ProjectReader::read_bodies() {
  for (const ProjectItem* item : file_.all())
    if (item->type == "BodyItem" && item->above("WorldItem") == world_) read_body(*item);
}

void ProjectReader::read_body(const ProjectItem& item) {
  Mapping keys = data_of(item, file_);
  ProjectBody body;
  body.item = &item;
  body.name = unique_name(item.name, body_names_);
  if (body.name != item.name)
    document().note(*item.node, fmt::format("the body {} is {} in the scenario, whose names are unique and without "
                                            "blanks; controllers read its own name",
                                            in_quotes(item.name), in_quotes(body.name)));
  body.self_collision = keys.flag({"self_collision_detection", "selfCollisionDetection"}).value_or(false);
  read_model(keys, body);
  if (body.model.links.empty()) return;  // reported
  read_pose(keys, body);
  read_posture(keys, body);
  read_root(keys, body);
  attach(item, keys, body);
  keys.find({"format"});
  if (settings_.obeys_collision_switch)
    body.touches = keys.flag({"collision_detection", "collisionDetection"}).value_or(true);
  if (const YamlNode* states = keys.find({"device_states"}))
    document().warning(*states, fmt::format("the states of devices that the project keeps for {} aren't read: its "
                                            "devices begin as its model states",
                                            in_quotes(item.name)));
  if (const YamlNode* handlers = keys.find({"extra_body_handlers"}))
    document().warning(*handlers, fmt::format("body handlers of {} are code of Choreonoid's; they are left out",
                                              in_quotes(item.name)));
  keys.finish(body_keys_without_effect);
  std::set<std::string> names;
  read_controllers(item, names, body.controllers);
  const std::size_t links = body.model.links.size(), joints = body.model.joints.size();
  taken(item,
        fmt::format("body {}: {}, {} link{}, {} joint{}", body.name, fs::path(body.model_file).filename().string(),
                    links, links == 1 ? "" : "s", joints, joints == 1 ? "" : "s"));
  bodies_.push_back(std::move(body));
}

void ProjectReader::read_model(Mapping& keys, ProjectBody& body) {
  const YamlNode* node = keys.find({"file", "modelFile", "model_file"});
  if (node == nullptr)
    return document().error(*body.item->node, fmt::format("the body {} names no model file", in_quotes(body.name)));
  const auto file = find_file(node->text, *node);
  if (!file) return;
  std::error_code ignored;
  if (!fs::is_regular_file(*file, ignored))
    return document().error(
        *node, fmt::format("there is no model file {}", in_quotes(node->text, 200)),
        fmt::format("looked for {}; --search DIR names a folder that has its end", file->lexically_normal().string()));
  const std::string ending = file->extension().string();
  if (ending == ".xacro")
    return document().error(*node, fmt::format("the model {} is a template of ROS", in_quotes(node->text, 200)),
                            "make a URDF with ROS's xacro, and name it in the project");
  body.model_file = seen_from_folder(*file);
  UrdfOptions options = options_.model;
  options.meshes = UrdfOptions::Meshes::skip;
  Result<Model> model = error("");
  if (ending == ".yaml" || ending == ".yml" || is_model_file(*file)) {
    model = load_model(*file, options);
  } else {
    wrap_mesh(*file, body);
    model = parse_model(files_.at(body.model_file), body.model_file, options);
  }
  if (model) {
    body.model = *std::move(model);
    return;
  }
  document().error(*node, fmt::format("the model {} can't be used", in_quotes(node->text, 200)));
  model_errors_.insert(model_errors_.end(), model.errors().begin(), model.errors().end());
}

/// Writes a .body file around a mesh file: a body of one fixed link.
void ProjectReader::wrap_mesh(const fs::path& mesh, ProjectBody& body) {
  body.model_file = body.name + ".body";
  files_[body.model_file] = fmt::format(
      "format: ChoreonoidBody\nformat_version: 2.0\nname: {0}\nlinks:\n  - name: {0}\n    joint_type: fixed\n"
      "    elements:\n      - {{type: Resource, uri: {1}}}\n",
      yaml_text(body.name), yaml_text(seen_from_folder(mesh)));
}

/// Reads the pose at which the run begins: the initial pose, else the world's origin, wherever the project shows the
/// body.
void ProjectReader::read_pose(Mapping& keys, ProjectBody& body) {
  body.pose.translation() =
      keys.vector({"initial_root_translation", "initialRootPosition"}).value_or(Eigen::Vector3d::Zero());
  if (const YamlNode* rotation = keys.find({"initial_root_rotation"})) {
    body.pose.linear() = read_rotation(*rotation, document()).value_or(Eigen::Matrix3d::Identity());
  } else if (const auto rows = keys.numbers({"initialRootAttitude"}, 9)) {
    Eigen::Matrix3d matrix;
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = (*rows)[static_cast<std::size_t>(i)];
    const Eigen::Quaterniond attitude(matrix);
    if ((matrix.transpose() * matrix - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 1e-3)
      document().error(*body.item->node,
                       fmt::format("the initial attitude of {} is no rotation", in_quotes(body.item->name)));
    body.pose.linear() = attitude.normalized().toRotationMatrix();
  }
}

void ProjectReader::read_posture(Mapping& keys, ProjectBody& body) {
  const auto read = [&keys](body::Names names) { return keys.numbers(names); };
  auto shown = read({"joint_displacements", "jointDisplacements"});
  auto initial = read({"initial_joint_displacements", "initialJointDisplacements"});
  const bool in_degrees = shown || initial;
  if (!in_degrees) {
    shown = read({"jointPositions", "joint_positions"});
    initial = read({"initialJointPositions", "initial_joint_positions"});
  } else {
    keys.find({"jointPositions", "initialJointPositions"});
  }
  const std::vector<double> first = initial.value_or(std::vector<double>()),
                            second = shown.value_or(std::vector<double>());
  const std::size_t count = std::max(first.size(), second.size());
  std::size_t unused = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = i < first.size() ? first[i] : second[i];
    const int link = link_of_joint(body.model, static_cast<int>(i));
    if (link < 0) ++unused;
    if (link < 0) continue;
    const Joint& joint = body.model.links[static_cast<std::size_t>(link)].joint;
    if (!is_movable(joint.type) && std::abs(value) >= least) ++unused;
    if (!is_movable(joint.type) || (std::abs(value) < least && joint.start == 0.0)) continue;
    body.posture.push_back({joint.name, value_text(joint, value, in_degrees)});
  }
  if (unused > 0)
    document().note(*body.item->node,
                    fmt::format("{} of {} joint values of {} aren't used: {} has {} joint{}", unused, count,
                                in_quotes(body.item->name), fs::path(body.model_file).filename().string(),
                                body.model.joints.size(), body.model.joints.size() == 1 ? "" : "s"));
}

void ProjectReader::read_root(Mapping& keys, ProjectBody& body) {
  const Model& model = body.model;
  body.has_limits = any_joint(model, is_limited);
  body.has_effort_limits = any_joint(model, has_effort_limit);
  body.has_drive_limits = any_joint(model, has_drive_limit);
  body.is_fixed_by_model = model.links.front().joint.type == JointType::fixed;
  const auto stated = keys.flag({"fix_root"});
  const auto is_static = keys.flag({"staticModel", "static_model"});
  const bool never_moves = std::none_of(model.links.begin() + 1, model.links.end(),
                                        [](const Link& link) { return link.joint.type != JointType::fixed; });
  body.fixed = stated.value_or(is_static.value_or(false)) || body.is_fixed_by_model;
  const bool is_freed =
      body.is_fixed_by_model && ((stated && !*stated) || (!stated && is_static && !*is_static && never_moves));
  if (is_freed)
    document().warning(*body.item->node,
                       fmt::format("the project sets {} free, and its model fixes the root link: it stays fixed",
                                   in_quotes(body.item->name)),
                       "jointType: free of the root link in the model's file");
}

/// A body that is attached to the body above it has the pose that the project shows.
void ProjectReader::attach(const ProjectItem& item, Mapping& keys, ProjectBody& body) {
  const bool is_attached =
      keys.flag({"enable_attachment"}).value_or(false) || keys.text({"parent_body_linkage"}).value_or("") == "attached";
  const std::string link = keys.text({"parent_link"}).value_or("");
  const YamlNode* shown = keys.find({"root_translation", "rootPosition"});
  const YamlNode* turned = keys.find({"root_rotation"});
  const auto rows = keys.numbers({"rootAttitude"}, 9);
  const ProjectItem* above = item.above("BodyItem");
  if (!is_attached || above == nullptr) return;
  const auto parent = std::ranges::find_if(bodies_, [&](const ProjectBody& other) { return other.item == above; });
  if (parent == bodies_.end()) return;  // it can't be used, which is reported
  if (shown != nullptr)
    body.pose.translation() = read_translation(*shown, document()).value_or(body.pose.translation());
  if (turned != nullptr) body.pose.linear() = read_rotation(*turned, document()).value_or(body.pose.linear());
  if (rows) {
    Eigen::Matrix3d matrix;
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = (*rows)[static_cast<std::size_t>(i)];
    body.pose.linear() = Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
  }
  const bool is_still = parent->fixed && parent->model.joints.empty();
  if (is_still) {
    body.fixed = true;
    return;
  }
  std::string place = parent->name;
  const auto holder = std::ranges::find_if(
      parent->model.devices, [](const Device& device) { return std::holds_alternative<Holder>(device.kind); });
  if (!link.empty() && parent->model.find_link(link) >= 0)
    place += "/" + link;
  else if (holder != parent->model.devices.end())
    place += "/" + parent->model.links[static_cast<std::size_t>(holder->link)].name;
  attachments_.push_back({place, body.name});
}

}  // namespace rehearse::import
