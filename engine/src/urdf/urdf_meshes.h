// <mesh filename scale>: finds and loads the meshes of one file.
#pragma once

#include <rehearse/urdf.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "mesh/mesh_file.h"
#include "mesh/mesh_paths.h"
#include "urdf_findings.h"

namespace tinyxml2 {
class XMLElement;
}

namespace rehearse::urdf {

class Meshes {
 public:
  /// `model_file`: relative paths are relative to it. `findings` must outlive this object.
  Meshes(const std::string& model_file, const UrdfOptions& options, Findings& findings);

  enum class Use { visual, collision };

  /// Returns nullopt with an error, or, where missing meshes are allowed, with a warning. A scale of one number is
  /// repaired in the document, too, because urdfdom refuses it.
  std::optional<Mesh> read(tinyxml2::XMLElement& element, Use use);

  /// The mesh with the triangles of its file, found by its name and line; nullopt likewise.
  std::optional<Mesh> load(Mesh mesh, Use use);

  /// The texture in that element's `filename`; null with a warning if it can't be used, or if meshes are skipped.
  std::shared_ptr<const Texture> read_texture(const tinyxml2::XMLElement& element);

  /// Sets Mesh::hulls of the collision meshes, where contacts don't take them for triangles and no hulls are there yet.
  /// An error for a mesh that can't be used.
  void prepare_contacts(Model& model);

 private:
  MeshSelection selection() const { return {.z_up = options_.mesh_z_up}; }
  std::optional<Eigen::Vector3d> read_scale(tinyxml2::XMLElement& element);
  MeshContact contact_of(const Mesh& mesh, bool never_moves);
  void take_hulls(Mesh& mesh, MeshContact contact);
  void refuse(int line, const std::string& file, const Diagnostic& reason, bool is_found);

  const UrdfOptions& options_;
  Findings& findings_;
  MeshPaths paths_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;  // by name as written; null: reported
};

}  // namespace rehearse::urdf
