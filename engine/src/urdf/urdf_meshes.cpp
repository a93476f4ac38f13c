#include "urdf_meshes.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <string_view>

#include "mesh/convex_parts.h"
#include "mesh/mesh_cache.h"
#include "mesh/picture_file.h"
#include "model/rigid_groups.h"
#include "urdf_values.h"

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

/// The geometry that contacts use for a mesh, from the extensions of other simulators.
MeshContact stated_contact(const XMLElement& element) {
  if (element.FirstChildElement("drake:declare_convex") != nullptr) return MeshContact::hull;
  const XMLElement* geometry = element.Parent()->ToElement();
  const XMLElement* collision = geometry ? geometry->Parent()->ToElement() : nullptr;
  const char* concave = collision ? collision->Attribute("concave") : nullptr;
  return concave != nullptr && std::string_view(concave) == "yes" ? MeshContact::triangles : MeshContact::automatic;
}

}  // namespace

Meshes::Meshes(const std::string& model_file, const UrdfOptions& options, Findings& findings)
    : options_(options), findings_(findings), paths_(model_file, options.packages) {}

std::optional<Mesh> Meshes::read(XMLElement& element, Use use) {
  const auto file = read_name(element, "filename", findings_);
  const auto scale = read_scale(element);
  if (!file || !scale) return std::nullopt;
  Mesh mesh{nullptr, nullptr, *file, *scale, nullptr, stated_contact(element), element.GetLineNum()};
  if (options_.meshes == UrdfOptions::Meshes::skip) return mesh;
  return load(std::move(mesh), use);
}

std::optional<Eigen::Vector3d> Meshes::read_scale(XMLElement& element) {
  const char* text = element.Attribute("scale");
  const std::string word = text == nullptr ? "" : text;
  std::string three;
  if (const auto one = parse_number(word)) three = fmt::format("{0} {0} {0}", *one);
  if (const auto four = parse_numbers(word, 4)) three = fmt::format("{} {} {}", (*four)[0], (*four)[1], (*four)[2]);
  if (!three.empty()) {
    findings_.repair(element.FindAttribute("scale")->GetLineNum(),
                     fmt::format("the scale of a <mesh> is {}; it is taken for {}", in_quotes(word), three));
    element.SetAttribute("scale", three.c_str());
  }
  const auto scale = read_vector_or(element, "scale", Eigen::Vector3d::Ones(), findings_);
  if (!scale || scale->cwiseAbs().minCoeff() > 0.0) return scale;
  findings_.error(element.FindAttribute("scale")->GetLineNum(),
                  fmt::format("the scale of a <mesh> is {}, with a factor of 0", in_quotes(element.Attribute("scale"))),
                  "1 1 1 keeps the size; -1 mirrors");
  return std::nullopt;
}

std::optional<Mesh> Meshes::load(Mesh mesh, Use use) {
  const int line = mesh.line;
  const Result<MeshPlace> place = paths_.find(mesh.file);
  if (!place) {
    refuse(line, mesh.file, place.errors().front(), false);
    return std::nullopt;
  }
  Result<SharedMesh> loaded = shared_mesh(place->file, mesh.scale, selection());
  if (!loaded) {
    refuse(line, mesh.file, loaded.errors().front(), true);
    return std::nullopt;
  }
  if (!place->warning.empty()) {
    findings_.warning(line, fmt::format("the mesh {}: {}", in_quotes(mesh.file, longest_path), place->warning),
                      "write its path, or state the folder of its package");
  }
  if (use == Use::visual) {  // the warnings are all about visual appearance
    for (const std::string& warning : loaded->warnings) {
      findings_.warning(line, fmt::format("the mesh {}: {}", in_quotes(mesh.file, longest_path), warning));
    }
  }
  mesh.data = std::move(loaded->data);
  return mesh;
}

std::shared_ptr<const Texture> Meshes::read_texture(const XMLElement& element) {
  const char* written = element.Attribute("filename");
  const std::string name = written ? written : "";
  if (name.empty()) findings_.ignored(element.GetLineNum(), "a <texture> without a filename");
  if (name.empty() || options_.meshes == UrdfOptions::Meshes::skip) return nullptr;
  const auto [known, is_new] = textures_.emplace(name, nullptr);
  if (!is_new) return known->second;
  const Result<MeshPlace> place = paths_.find(name);
  Result<Texture> texture = place ? read_picture(place->file, name) : Result<Texture>(place.errors());
  if (!texture) {
    const std::string which = fmt::format("the <texture> {} of a material isn't drawn", in_quotes(name, longest_path));
    // the reason may contain a path of this machine
    findings_.warning(element.GetLineNum(),
                      place ? which + ": " + texture.errors().front().message : which + ": it isn't there");
    return nullptr;
  }
  return known->second = std::make_shared<const Texture>(*std::move(texture));
}

void Meshes::prepare_contacts(Model& model) {
  const RigidGroups groups = group_links(model);
  const bool is_fixed = options_.fixed_root || model.links.front().joint.type == JointType::fixed;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    for (Shape& shape : model.links[i].collisions) {
      auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (!mesh || !mesh->data || mesh->hulls) continue;
      const MeshContact contact = contact_of(*mesh, is_fixed && groups.links[i].group == 0);
      if (contact != MeshContact::triangles) take_hulls(*mesh, contact);
    }
  }
}

MeshContact Meshes::contact_of(const Mesh& mesh, bool never_moves) {
  const MeshContact wanted = options_.contact == MeshContact::automatic ? mesh.contact : options_.contact;
  if (wanted == MeshContact::hull || wanted == MeshContact::parts) return wanted;
  if (!never_moves) return MeshContact::parts;
  constexpr double rounding = 1e-3;
  const bool as_convex = wanted == MeshContact::automatic && is_convex(*mesh.data, rounding);
  return as_convex ? MeshContact::hull : MeshContact::triangles;
}

void Meshes::take_hulls(Mesh& mesh, MeshContact contact) {
  const std::string which = fmt::format("the mesh {}", in_quotes(mesh.file, longest_path));
  const auto hulls = shared_hulls(mesh.data->file, mesh.scale, contact, selection());
  if (!hulls) {
    findings_.error(mesh.line, fmt::format("{} can't be used for contact: {}", which, hulls.errors().front().message),
                    "contacts use convex parts of a mesh that moves");
    return;
  }
  for (const Diagnostic& remark : (*hulls)->remarks) {
    const std::string message = fmt::format("{}: {}", which, remark.message);
    if (remark.severity == Severity::note)
      findings_.note(mesh.line, message, remark.hint);
    else
      findings_.warning(mesh.line, message, remark.hint);
  }
  mesh.hulls = {*hulls, &(*hulls)->hulls};
}

/// Recordings contain warnings, so a warning can't contain the search paths of this machine.
void Meshes::refuse(int line, const std::string& file, const Diagnostic& reason, bool is_found) {
  const std::string which = fmt::format("the mesh {} can't be used", in_quotes(file, longest_path));
  const std::string where = reason.line > 0 ? fmt::format("line {}: ", reason.line) : "";
  if (!options_.allow_missing_meshes) {
    findings_.error(line, fmt::format("{}: {}{}", which, where, reason.message), reason.hint);
  } else {
    findings_.warning(line, fmt::format("{}{}; its shape is left out", which,
                                        is_found ? fmt::format(": {}{}", where, reason.message) : ": it isn't there"));
  }
}

}  // namespace rehearse::urdf
