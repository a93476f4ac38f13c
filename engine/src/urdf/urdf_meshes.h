// <mesh filename scale>: finds and loads the meshes of one file.
#pragma once

#include <rehearse/urdf.h>

#include <optional>

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

 private:
  std::optional<Eigen::Vector3d> read_scale(tinyxml2::XMLElement& element);
  std::optional<Mesh> load(const tinyxml2::XMLElement& element, Mesh mesh, Use use);
  bool take_hulls(int line, const std::filesystem::path& file, Mesh& mesh);
  void refuse(int line, const std::string& file, const Diagnostic& reason, bool is_found);

  const UrdfOptions& options_;
  Findings& findings_;
  MeshPaths paths_;
};

}  // namespace rehearse::urdf
