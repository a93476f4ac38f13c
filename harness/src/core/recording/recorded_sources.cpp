#include "recorded_sources.h"

#include <filesystem>
#include <set>
#include <utility>
#include <variant>

#include "provenance.h"

namespace rehearse {
namespace {

/// The load report of all bodies of that file: they may have loaded it with different options, and so with different
/// repairs. Repairs that a later body shares with earlier ones are reported once.
std::string load_report(const Scenario& scenario, const std::string& model_file) {
  std::string text;
  std::set<std::string> told;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.model_file != model_file) continue;
    std::vector<std::string> lines;
    for (Diagnostic finding : body.model->report) {
      finding.file = model_file;
      lines.push_back(to_string({finding}));
    }
    for (const std::string& line : lines)
      if (told.count(line) == 0) text += line;
    told.insert(lines.begin(), lines.end());
  }
  return text;
}

/// The media type of the file that a model was read from: a URDF, a .body file, or a heightmap.
const char* media_type_of(const ScenarioBody& body) {
  const Link& root = body.model->links.front();
  const Mesh* mesh = root.visuals.empty() ? nullptr : std::get_if<Mesh>(&root.visuals.front().geometry);
  const std::string ending = std::filesystem::path(body.model_file).extension();
  if (ending == ".wrl") return "model/vrml";
  if (ending == ".body" || ending == ".yaml" || ending == ".yml") return "application/yaml";
  if (!mesh || !mesh->heightmap) return "application/xml";
  return mesh->file.ends_with(".png") ? "image/png" : "text/plain";
}

}  // namespace

std::vector<SourceFile> sources_of(const Scenario& scenario) {
  std::vector<SourceFile> sources{{"scenario.yaml", "application/yaml", scenario.text}};
  std::set<std::string> attached;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.model_file.empty() || !attached.insert(body.model_file).second) continue;
    sources.push_back({body.model_file, media_type_of(body), body.model->source_text});
    sources.push_back({body.model_file + ".report", "text/plain", load_report(scenario, body.model_file)});
    std::string meshes = mesh_digests(*body.model);
    if (!meshes.empty()) sources.push_back({body.model_file + ".meshes", "text/plain", std::move(meshes)});
  }
  return sources;
}

}  // namespace rehearse
