#include "mesh_digests.h"

#include <fmt/format.h>

#include <set>

namespace rehearse {

std::string mesh_digests(const Model& model) {
  std::string text;
  std::set<std::string> listed;
  const auto add = [&](const std::string& digest, const std::string& file) {
    if (listed.insert(file).second) text += fmt::format("{}  {}\n", digest, file);
  };
  const auto list = [&](const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) {
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh != nullptr && !mesh->heightmap && !mesh->file.empty()) add(mesh->data->digest, mesh->file);
      if (shape.texture && !shape.texture->digest.empty()) add(shape.texture->digest, shape.texture->file);
    }
  };
  for (const Link& link : model.links) {
    list(link.visuals);
    list(link.collisions);
  }
  return text;
}

}  // namespace rehearse
