#include "mesh_digests.h"

#include <fmt/format.h>

#include <set>

namespace rehearse {

std::string mesh_digests(const Model& model) {
  std::string text;
  std::set<std::string> listed;
  const auto list = [&](const std::vector<Shape>& shapes) {
    for (const Shape& shape : shapes) {
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh != nullptr && listed.insert(mesh->file).second)
        text += fmt::format("{}  {}\n", mesh->data->digest, mesh->file);
    }
  };
  for (const Link& link : model.links) {
    list(link.visuals);
    list(link.collisions);
  }
  return text;
}

}  // namespace rehearse
