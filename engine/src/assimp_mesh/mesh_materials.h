// The colours and textures of a mesh file.
#pragma once

#include <rehearse/model.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mesh/mesh_format.h"
#include "mesh/mesh_input.h"

struct aiMaterial;
struct aiScene;

namespace rehearse {

/// The colour and texture of the triangles of one material.
struct Paint {
  std::optional<Eigen::Vector4f> color;    // red, green, blue, opacity; nullopt: the file states no colour
  std::shared_ptr<const Texture> texture;  // null: no texture
  unsigned channel = 0;                    // of the texture coordinates that the texture uses
  bool is_default = false;                 // the program that wrote the file added the material by itself
};

/// The materials of a scene. Diffuse colours, or glTF's base colours, and the pictures in their place:
/// - STL has no colours: the colour that some programs write into the file's header is ignored.
/// - OBJ states a colour if the material has a Kd; it is multiplied with the picture, unless it is black.
/// - A DAE states a colour or a picture. A colour without any opacity is taken for opaque, with a warning: exporters
///   disagree on which end of the scale is opaque.
/// - A glTF's base colour is linear and is converted to sRGB; its opacity counts only if its mode is BLEND or MASK.
/// A grey without a picture, of a material with one of the names that programs give by themselves, is a default.
/// Other maps and vertex colours aren't read. A picture that can't be read is a warning.
class MeshMaterials {
 public:
  MeshMaterials(const aiScene& scene, MeshFormat format, MeshInput& input, std::vector<std::string>& warnings);

  /// By the index of the scene's material.
  const Paint& operator[](unsigned index) const;

 private:
  Paint read(const aiMaterial& material);
  std::optional<Eigen::Vector4f> read_color(const aiMaterial& material, const std::string& name, bool names_texture,
                                            bool has_texture);
  std::shared_ptr<const Texture> read_texture(const std::string& path);
  Result<Texture> decode(const std::string& path);
  void find_stated_colors();

  const aiScene& scene_;
  MeshFormat format_;
  MeshInput& input_;
  std::vector<std::string>& warnings_;
  std::set<std::string> stated_;                                    // OBJ: names of the materials that have a Kd
  std::map<std::string, std::shared_ptr<const Texture>> textures_;  // by path; null: unreadable, already reported
  std::vector<Paint> paints_;
};

}  // namespace rehearse
