#include <rehearse/mjcf.h>

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "mesh/mesh_input.h"
#include "mjcf_bodies.h"
#include "model/rigid_groups.h"
#include "urdf/urdf_text.h"
#include "urdf/urdf_values.h"

namespace rehearse {
namespace {

using mjcf::Draft;
using mjcf::Files;

/// Sections that change nothing of a model here, those that are read, and the rest.
void check_sections(Files& files) {
  for (const mjcf::XMLElement* section : files.children(*files.root())) {
    const std::string_view name = section->Name();
    if (urdf::is_one_of(name, {"compiler", "default", "asset", "worldbody", "actuator", "sensor", "equality", "contact",
                               "keyframe"}))
      continue;
    if (urdf::is_one_of(name, {"option", "size", "visual", "statistic", "custom"})) {
      files.ignored(*section, urdf::tag(name));
    } else if (urdf::is_one_of(name, {"tendon", "deformable", "extension"})) {
      if (section->FirstChildElement() != nullptr) files.unsupported(*section, urdf::tag(name));
    } else {
      files.error(*section, fmt::format("unknown section {} of <mujoco>", urdf::tag(name)),
                  "compiler, default, asset, worldbody, contact, equality, actuator, sensor or keyframe");
    }
  }
}

/// Reads all files into a draft.
struct Reading {
  explicit Reading(Files& of) : files(of), classes(of) {
    classes.read();
    compiler = read_compiler(files);
    geoms = std::make_unique<mjcf::Geoms>(files, classes, compiler);
    geoms->read_assets();
    mjcf::Bodies(files, classes, compiler, *geoms, draft).read();
    mjcf::read_actuators(files, classes, compiler, draft);
  }

  Files& files;
  mjcf::Classes classes;
  mjcf::Compiler compiler;
  std::unique_ptr<mjcf::Geoms> geoms;
  Draft draft;
};

/// Gives the links between the joints of a body a share of the mass and inertia of what that body carries: the physics
/// needs a mass of each link that moves.
void give_masses_between(const Draft& draft, double share, Model& model) {
  for (const std::string& name : draft.between) {
    Inertial& inertial = model.links[static_cast<std::size_t>(model.find_link(name))].inertial;
    inertial = Inertial();
  }
  const RigidGroups groups = group_links(model);
  for (const std::string& name : draft.between) {
    const int link = model.find_link(name);
    int body = link;  // the one with all joints
    while (std::ranges::find(draft.between, model.links[static_cast<std::size_t>(body)].name) != draft.between.end())
      body = static_cast<int>(std::ranges::find(model.links, body, &Link::parent) - model.links.begin());
    const auto group = static_cast<std::size_t>(groups.links[static_cast<std::size_t>(body)].group);
    const Inertial& carried = groups.inertials[group];
    Inertial& inertial = model.links[static_cast<std::size_t>(link)].inertial;
    inertial.mass = share * carried.mass;
    inertial.inertia = share * principal_moments(carried.inertia).z() * Eigen::Matrix3d::Identity();
  }
}

/// Checks the model's masses as those of a URDF.
void complete(Model& model, const Draft& draft, const UrdfOptions& options, urdf::Findings& findings) {
  const urdf::MassHints hints{"give it an <inertial>, or geoms with a mass", {}};
  give_masses_between(draft, 1.0, model);  // so that the checks find what moves in them
  urdf::complete_masses(model, options, findings, hints);
  urdf::repair_inertias(model, options, findings);
  urdf::check_dynamics(model, options, findings);
  constexpr double small = 1e-9;
  give_masses_between(draft, small, model);
}

std::optional<Model> read_model(Files& files, const std::string& name) {
  check_sections(files);
  Reading reading(files);
  Draft& draft = reading.draft;
  mjcf::read_sensors(files, draft);
  mjcf::read_equalities(files, reading.classes, draft);
  if (draft.tree.links.size() > max_urdf_links)
    files.main_findings().error(
        0, fmt::format("the model has {} links, more than {}", draft.tree.links.size(), max_urdf_links));
  const char* written = files.root()->Attribute("model");
  draft.tree.name = written && *written ? printable(written) : std::filesystem::path(name).stem().string();
  if (files.has_error()) return std::nullopt;
  urdf::Findings& findings = files.main_findings();
  std::optional<Model> model = urdf::join(draft.tree, findings);
  if (!model) return std::nullopt;
  Joint& root = model->links.front().joint;
  root.type = draft.root_is_free ? JointType::free : JointType::fixed;
  root.origin = draft.root_origin;
  mjcf::apply_contact_rules(files, draft, *model);
  mjcf::read_keyframes(files, draft, *model);
  complete(*model, draft, files.options(), findings);
  if (!files.skips_meshes()) reading.geoms->prepare_contacts(*model);
  return model;
}

}  // namespace

bool is_mjcf(std::string_view text) {
  std::string_view rest = text.substr(urdf::end_of_prolog(text));
  constexpr std::string_view begin = "<mujoco";
  if (!rest.starts_with(begin)) return false;
  rest.remove_prefix(begin.size());
  return rest.empty() || std::string_view(" \t\r\n/>").find(rest.front()) != std::string_view::npos;
}

Result<Model> parse_mjcf(const std::string& text, const std::string& name, const UrdfOptions& options) {
  REHEARSE_ASSERT(options.default_mass.value_or(1.0) > 0.0, "a default mass is above 0");
  Files files(text, name, options);
  std::optional<Model> model;
  if (files.root() != nullptr) model = read_model(files, name);
  if (files.has_error()) return files.errors();
  REHEARSE_ASSERT(model.has_value(), "a model that can't be read has an error");
  model->source_file = name;
  model->source_text = files.bundle();
  model->report = files.report();
  return std::move(*model);
}

Result<std::vector<MjcfDrive>> load_mjcf_drives(const std::filesystem::path& file) {
  const std::string text = REHEARSE_TRY(read_mesh_file(file));
  const UrdfOptions options{.allow_unsupported = true, .meshes = UrdfOptions::Meshes::skip};
  Files files(text, file.string(), options);
  if (files.root() == nullptr) return files.errors();
  const Reading reading(files);
  if (files.has_error()) return files.errors();
  return reading.draft.drives;
}

}  // namespace rehearse
