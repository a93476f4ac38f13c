// Resources: meshes and YAML scenes in files of their own.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "body_elements.h"
#include "mesh/mesh_cache.h"

namespace rehearse::body {
namespace {

/// The unit and the axis that points up in a mesh file, by `metadata`: a mapping, or words in old files.
Eigen::Affine3d read_metadata(const YamlNode& node, Document& document) {
  std::string unit, up;
  if (node.kind == YamlNode::Kind::map) {
    Mapping keys(node, "metadata", document);
    unit = keys.text({"length_unit"}).value_or("");
    up = keys.text({"upper_axis"}).value_or("");
    keys.finish();
  } else {
    for (const char* word : {"millimeter", "inch"})
      if (node.text.find(word) != std::string::npos) unit = word;
    if (node.text.find("y_upper") != std::string::npos) up = "Y";
  }
  Eigen::Affine3d place = Eigen::Affine3d::Identity();
  const double factor = unit == "millimeter" ? 0.001 : unit == "inch" ? 0.0254 : unit == "centimeter" ? 0.01 : 1.0;
  if (factor == 1.0 && !unit.empty() && unit != "meter")
    document.warning(node, fmt::format("the unit {} isn't known", in_quotes(unit)), "meter, millimeter or inch");
  if (up == "Y") place.linear() = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  place.linear() *= factor;
  return place;
}

bool has_ending(const std::string& uri, std::initializer_list<std::string_view> endings) {
  std::string ending = std::filesystem::path(uri).extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::ranges::find(endings, ending) != endings.end();
}

/// Finds all nodes of files that a document names, by uri.
void collect_fragments(const YamlNode& node, std::map<std::string, std::set<std::string>>& fragments) {
  const YamlNode *uri = nullptr, *fragment = nullptr;
  for (std::size_t i = 0; i < node.keys.size() && i < node.items.size(); ++i) {
    if (node.keys[i]->text == "uri") uri = node.items[i].get();
    if (node.keys[i]->text == "node" || node.keys[i]->text == "fragment") fragment = node.items[i].get();
  }
  if (uri != nullptr && fragment != nullptr) fragments[uri->text].insert(fragment->text);
  for (const YamlNodePtr& item : node.items) collect_fragments(*item, fragments);
}

}  // namespace

/// The names of the nodes that the body takes out of the file. They are no longer part of the file's other nodes.
const std::set<std::string>& ElementReader::fragments_of(const std::string& uri) {
  if (!knows_fragments_) {
    collect_fragments(*main_.root, fragments_);
    knows_fragments_ = true;
  }
  return fragments_[uri];
}

void ElementReader::read_resource(Mapping& keys, const Place& place) {
  Document& document = *place.document;
  const YamlNode& at = keys.node();
  Place below = place;
  below.transform = place.transform * keys.transform();
  ++below.depth;
  const auto uri = keys.text({"uri"});
  const std::string fragment = keys.text({"fragment", "node"}).value_or("");
  const YamlNode* metadata = keys.find({"metadata"});
  if (!uri) return document.error(at, "a Resource has no uri", "uri: the path of a mesh or of a YAML file");
  const Result<NamedFile> file = files_.find(*uri, document);
  if (!file) {
    const Diagnostic& reason = file.errors().front();
    const std::string message = fmt::format("the resource {} can't be used: {}", in_quotes(*uri), reason.message);
    return files_.options().allow_missing_meshes ? document.warning(at, message)
                                                 : document.error(at, message, reason.hint);
  }
  if (has_ending(*uri, {".yaml", ".yml"})) return read_yaml(at, *file, fragment, below);
  if (metadata != nullptr) below.transform = below.transform * read_metadata(*metadata, document);
  read_mesh(at, *uri, *file, fragment, below.transform, {}, below);
}

void ElementReader::read_yaml(const YamlNode& at, const NamedFile& file, const std::string& fragment,
                              const Place& place) {
  Diagnostic problem;
  Document* opened = files_.open(file, main_.anchors, problem);
  if (opened == nullptr) {
    const std::string where = problem.line > 0 ? fmt::format("line {}: ", problem.line) : "";
    return place.document->error(
        at, fmt::format("the resource {} can't be used: {}{}", in_quotes(file.key), where, problem.message),
        problem.hint);
  }
  opened->degrees = main_.degrees;  // the file's own unit isn't read
  Place below = place;
  below.document = opened;
  if (fragment.empty()) return read_all(*opened->root, below);
  for (const YamlAnchors* anchors : {&opened->anchors, &main_.anchors})
    if (const auto known = anchors->find(fragment); known != anchors->end()) return read_all(*known->second, below);
  place.document->error(at, fmt::format("the resource {} has no anchor {}", in_quotes(file.key), in_quotes(fragment)));
}

void ElementReader::read_mesh(const YamlNode& at, const std::string& uri, const NamedFile& file,
                              const std::string& fragment, const Eigen::Affine3d& transform, Shape shape,
                              const Place& place) {
  Document& document = *place.document;
  Mesh mesh{nullptr, nullptr, uri};
  Eigen::Matrix3d rotation;
  if (!split(transform.linear(), rotation, mesh.scale))
    return document.warning(at, fmt::format("the mesh {} is sheared; it is left out", in_quotes(uri)));
  mesh.scale = mesh.scale.unaryExpr([](double s) { return std::abs(s - 1.0) < 1e-12 ? 1.0 : s; });
  shape.pose.translation() = transform.translation();
  shape.pose.linear() = rotation;
  if (!files_.skips_meshes()) {
    MeshSelection selection{fragment, fragments_of(uri), files_.options().mesh_z_up};
    selection.without.erase(fragment);
    const auto loaded = shared_mesh(file.file, mesh.scale, selection);
    const bool in_parts = files_.options().contact == MeshContact::parts;
    const MeshContact contact = in_parts ? MeshContact::parts : MeshContact::hull;
    const auto hulls = loaded && !place.is_visual ? shared_hulls(file.file, mesh.scale, contact, selection)
                                                  : Result<std::shared_ptr<const ConvexHulls>>(nullptr);
    if (!loaded || !hulls) {
      const Diagnostic& reason = loaded ? hulls.errors().front() : loaded.errors().front();
      const std::string where = reason.line > 0 ? fmt::format("line {}: ", reason.line) : "";
      const std::string what = fmt::format("the mesh {} can't be used", in_quotes(uri, urdf::longest_path));
      if (files_.options().allow_missing_meshes)
        return document.warning(at, fmt::format("{}; its shape is left out", what));
      return document.error(at, fmt::format("{}: {}{}", what, where, reason.message), reason.hint);
    }
    for (const std::string& warning : loaded->warnings)
      document.warning(at, fmt::format("the mesh {}: {}", in_quotes(uri, urdf::longest_path), warning));
    mesh.data = loaded->data;
    if (*hulls != nullptr) {
      for (const Diagnostic& remark : (*hulls)->remarks)
        document.note(at, fmt::format("the mesh {}: {}", in_quotes(uri, urdf::longest_path), remark.message));
      mesh.hulls = {*hulls, &(*hulls)->hulls};
    }
  }
  shape.geometry = std::move(mesh);
  add_shape(at, std::move(shape), place);
}

}  // namespace rehearse::body
