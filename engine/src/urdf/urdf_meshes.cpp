#include "urdf_meshes.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include "mesh/mesh_cache.h"
#include "urdf_values.h"

namespace rehearse::urdf {

using tinyxml2::XMLElement;

Meshes::Meshes(const std::string& model_file, const UrdfOptions& options, Findings& findings)
    : options_(options), findings_(findings), paths_(model_file, options.packages) {}

std::optional<Mesh> Meshes::read(XMLElement& element, Use use) {
  const auto file = read_name(element, "filename", findings_);
  const auto scale = read_scale(element);
  if (!file || !scale) return std::nullopt;
  Mesh mesh{nullptr, nullptr, *file, *scale};
  if (options_.meshes == UrdfOptions::Meshes::skip) return mesh;
  return load(element, std::move(mesh), use);
}

std::optional<Eigen::Vector3d> Meshes::read_scale(XMLElement& element) {
  const char* text = element.Attribute("scale");
  const std::optional<double> one = parse_number(text == nullptr ? "" : text);
  if (one) {
    const std::string word = text;
    const std::string three = fmt::format("{0} {0} {0}", *one);
    findings_.repair(element.FindAttribute("scale")->GetLineNum(),
                     fmt::format("the scale of a <mesh> is {}; it is taken for all three axes", in_quotes(word)),
                     fmt::format("write scale=\"{}\"", three));
    element.SetAttribute("scale", three.c_str());
  }
  const auto scale = read_vector_or(element, "scale", Eigen::Vector3d::Ones(), findings_);
  if (!scale || scale->cwiseAbs().minCoeff() > 0.0) return scale;
  findings_.error(
      element.FindAttribute("scale")->GetLineNum(),
      fmt::format("the scale of a <mesh> is {}, and nothing is left of it", in_quotes(element.Attribute("scale"))),
      "1 1 1 leaves it as it is; -1 mirrors");
  return std::nullopt;
}

std::optional<Mesh> Meshes::load(const XMLElement& element, Mesh mesh, Use use) {
  const int line = element.GetLineNum();
  const Result<MeshPlace> place = paths_.find(mesh.file);
  if (!place) {
    refuse(line, mesh.file, place.errors().front(), false);
    return std::nullopt;
  }
  Result<SharedMesh> loaded = shared_mesh(place->file, mesh.scale);
  if (!loaded) {
    refuse(line, mesh.file, loaded.errors().front(), true);
    return std::nullopt;
  }
  if (!place->warning.empty()) {
    findings_.warning(line, fmt::format("the mesh {}: {}", in_quotes(mesh.file, longest_path), place->warning),
                      "write where it is, or say where its package is");
  }
  if (use == Use::visual) {  // the warnings are all about visual appearance
    for (const std::string& warning : loaded->warnings) {
      findings_.warning(line, fmt::format("the mesh {}: {}", in_quotes(mesh.file, longest_path), warning));
    }
  }
  mesh.data = std::move(loaded->data);
  if (use == Use::collision && !take_hulls(line, place->file, mesh)) return std::nullopt;
  return mesh;
}

bool Meshes::take_hulls(int line, const std::filesystem::path& file, Mesh& mesh) {
  const std::string which = fmt::format("the mesh {}", in_quotes(mesh.file, longest_path));
  const auto hulls = shared_hulls(file, mesh.scale);
  if (!hulls) {
    findings_.error(line, fmt::format("{} can't be used for contact: {}", which, hulls.errors().front().message),
                    "contact takes a mesh for the convex hull of each of its objects");
    return false;
  }
  for (const Diagnostic& remark : (*hulls)->remarks) {
    const std::string message = fmt::format("{}: {}", which, remark.message);
    if (remark.severity == Severity::note)
      findings_.note(line, message, remark.hint);
    else
      findings_.warning(line, message, remark.hint);
  }
  mesh.hulls = {*hulls, &(*hulls)->hulls};
  return true;
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
