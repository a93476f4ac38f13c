#include <rehearse/body.h>
#include <rehearse/mjcf.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "body_document.h"
#include "body_draft.h"
#include "mesh/convex_parts.h"
#include "mesh/mesh_input.h"
#include "model/rigid_groups.h"
#include "urdf/urdf_draft.h"

namespace rehearse {
namespace {

/// True if the text of a file that may be a body is one. A .yaml may be anything, and a .wrl a mesh.
bool describes_body(const std::filesystem::path& file, std::string_view text) {
  if (file.extension() == ".wrl") return text.find("Humanoid") != std::string_view::npos;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view line = text.substr(at, text.find('\n', at) - at);
    for (const std::string_view key : {"format:", "modelFile:", "model_file:"})
      if (line.starts_with(key)) return key != "format:" || line.find("ChoreonoidBody") != std::string_view::npos;
    at += line.size() + 1;
  }
  return false;
}

/// The masses and inertias that ODE needs, as for a URDF.
void complete(Model& model, const UrdfOptions& options, const urdf::MassHints& hints, urdf::Findings& findings) {
  urdf::complete_masses(model, options, findings, hints);
  urdf::repair_inertias(model, options, findings);
  urdf::check_dynamics(model, options, findings);
}

/// A mesh that never moves is touched as it is, unless it is convex or the caller wants its hull or parts.
void take_triangles(Model& model, const UrdfOptions& options) {
  const bool is_fixed = options.fixed_root || model.links.front().joint.type == JointType::fixed;
  if (!is_fixed || options.contact == MeshContact::hull || options.contact == MeshContact::parts) return;
  constexpr double rounding = 1e-3;
  const RigidGroups groups = group_links(model);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (groups.links[i].group != 0) continue;
    for (Shape& shape : model.links[i].collisions) {
      auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (!mesh || !mesh->data) continue;
      if (options.contact == MeshContact::triangles || !is_convex(*mesh->data, rounding)) mesh->hulls = nullptr;
    }
  }
}

}  // namespace

Result<Model> load_body(const std::filesystem::path& file, const UrdfOptions& options) {
  std::string text = REHEARSE_TRY(read_mesh_file(file));
  if (text.size() > max_body_bytes)
    return error_in(file.string(),
                    fmt::format("the file has {} bytes, more than {} MiB", text.size(), max_body_bytes >> 20));
  return parse_body(text, file.string(), options);
}

Result<Model> parse_body(const std::string& text, const std::string& name, const UrdfOptions& options) {
  REHEARSE_ASSERT(options.default_mass.value_or(1.0) > 0.0, "a default mass is above 0");
  body::Files files(text, name, options);
  if (files.has_error()) return files.errors();
  body::BodyDraft draft = body::read_body(files, files.main());
  if (files.has_error()) return files.errors();
  urdf::MassHints hints{"give it a mass, or it or a link fixed to it a RigidBody", {}};
  for (const body::LinkDraft& link : draft.links)
    if (!link.mass_hint.empty()) hints.of_links[link.link.name] = link.mass_hint;
  std::optional<Model> model = body::join(std::move(draft), files);
  if (model) complete(*model, options, hints, files.main().findings());
  if (model) take_triangles(*model, options);
  if (files.has_error()) return files.errors();
  REHEARSE_ASSERT(model.has_value(), "a body that can't be read has an error");
  model->source_file = name;
  model->source_text = files.bundle();
  model->report = files.report();
  return std::move(*model);
}

bool body::is_body_name(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".body" || ending == ".yaml" || ending == ".yml" || ending == ".wrl";
}

bool is_model_file(const std::filesystem::path& file) {
  if (file.extension() == ".body" || file.extension() == ".urdf") return true;
  const bool may_be_one = body::is_body_name(file) || file.extension() == ".xml";
  const Result<std::string> text = may_be_one ? read_mesh_file(file) : Result<std::string>("");
  return text && (body::is_body_name(file) ? describes_body(file, *text) : is_mjcf(*text));
}

Result<Model> load_model(const std::filesystem::path& file, const UrdfOptions& options) {
  if (body::is_body_name(file)) return load_body(file, options);
  const Result<std::string> text = read_mesh_file(file);
  if (text && is_mjcf(*text)) return parse_mjcf(*text, file.string(), options);
  return load_urdf(file, options);
}

Result<Model> parse_model(const std::string& text, const std::string& name, const UrdfOptions& options) {
  if (body::is_body_name(name)) return parse_body(text, name, options);
  return is_mjcf(text) ? parse_mjcf(text, name, options) : parse_urdf(text, name, options);
}

}  // namespace rehearse
