#include "mesh_materials.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "mesh/picture_file.h"

namespace rehearse {
namespace {

std::string text_of(const aiString& text) { return {text.data, text.length}; }

bool is_gltf(MeshFormat format) { return format == MeshFormat::gltf || format == MeshFormat::glb; }

/// sRGB of a linear intensity, 0 to 1 (IEC 61966-2-1).
float srgb_of_linear(float linear) {
  const double value = linear;
  return static_cast<float>(value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055);
}

/// True for names that programs give to the material of an object without one, as in Material.001 or lambert1-effect.
bool is_default_name(std::string_view name) {
  for (const std::string_view suffix : {"-material", "-effect", "-fx"})
    if (name.ends_with(suffix)) name.remove_suffix(suffix.size());
  name = name.substr(0, name.find_last_not_of("0123456789._- ") + 1);
  std::string word;
  for (const char c : name) word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const char* known : {"", "default", "defaultmaterial", "default_material", "initialshadinggroup", "lambert",
                            "material", "mat", "none", "phong"}) {
    if (word == known) return true;
  }
  return false;
}

bool is_grey(const Eigen::Vector4f& color) { return color.x() == color.y() && color.y() == color.z(); }

/// A texture that is embedded in the file.
Result<Texture> decode_embedded(const aiTexture& embedded) {
  const auto* bytes = reinterpret_cast<const char*>(embedded.pcData);
  if (embedded.mHeight == 0) return decode_texture({bytes, embedded.mWidth});
  return error("its pixels aren't compressed", "PNG and JPEG are read");
}

}  // namespace

MeshMaterials::MeshMaterials(const aiScene& scene, MeshFormat format, MeshInput& input,
                             std::vector<std::string>& warnings)
    : scene_(scene), format_(format), input_(input), warnings_(warnings) {
  if (format == MeshFormat::stl) {
    paints_.resize(scene.mNumMaterials);
    return;
  }
  if (format == MeshFormat::obj) find_stated_colors();
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) paints_.push_back(read(*scene.mMaterials[i]));
}

const Paint& MeshMaterials::operator[](unsigned index) const {
  static const Paint none;
  return index < paints_.size() ? paints_[index] : none;
}

/// The materials for which the file states a colour; assimp gives every material a colour, stated or not.
void MeshMaterials::find_stated_colors() {
  for (const auto& [path, bytes] : input_.others()) {
    std::string_view rest = *bytes;
    std::string material;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      std::string_view line = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
      while (line.ends_with('\r') || line.ends_with(' ') || line.ends_with('\t')) line.remove_suffix(1);
      if (line.starts_with("newmtl ")) material = line.substr(line.find_first_not_of(" \t", 6));
      if (line.starts_with("Kd ")) stated_.insert(material);
    }
  }
}

Paint MeshMaterials::read(const aiMaterial& material) {
  aiString name;
  material.Get(AI_MATKEY_NAME, name);
  Paint paint;
  aiString path;
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (material.GetTexture(type, 0, &path, nullptr, &paint.channel) != AI_SUCCESS) continue;
    aiUVTransform transform;
    if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == AI_SUCCESS &&
        (transform.mTranslation != aiVector2D() || transform.mScaling != aiVector2D(1, 1) ||
         transform.mRotation != 0)) {
      warnings_.push_back(fmt::format("the transform of texture '{}' isn't applied", text_of(path)));
    }
    paint.texture = read_texture(text_of(path));
    break;
  }
  paint.color = read_color(material, text_of(name), path.length > 0, paint.texture != nullptr);
  paint.is_default = paint.texture == nullptr && paint.color && is_grey(*paint.color) && is_default_name(text_of(name));
  aiString alpha_mode;
  const bool is_opaque =
      material.Get(AI_MATKEY_GLTF_ALPHAMODE, alpha_mode) == AI_SUCCESS && text_of(alpha_mode) == "OPAQUE";
  if (!is_opaque || !is_gltf(format_)) return paint;
  if (paint.color) paint.color->w() = 1.0f;
  if (paint.texture != nullptr) {
    auto opaque = std::make_shared<Texture>(*paint.texture);
    for (std::size_t i = 3; i < opaque->rgba.size(); i += 4) opaque->rgba[i] = 255;
    paint.texture = std::move(opaque);
  }
  return paint;
}

std::optional<Eigen::Vector4f> MeshMaterials::read_color(const aiMaterial& material, const std::string& name,
                                                         bool names_texture, bool has_texture) {
  if (name == AI_DEFAULT_MATERIAL_NAME) return std::nullopt;
  aiColor4D found(1, 1, 1, 1);
  if (is_gltf(format_)) {
    const bool is_default = name.empty() && &material == scene_.mMaterials[scene_.mNumMaterials - 1];
    if (is_default || material.Get(AI_MATKEY_BASE_COLOR, found) != AI_SUCCESS) return std::nullopt;
    for (float* value : {&found.r, &found.g, &found.b}) *value = srgb_of_linear(*value);
  } else {
    const bool is_stated = format_ == MeshFormat::obj ? stated_.contains(name) : !names_texture;
    if (!is_stated && !has_texture) return std::nullopt;
    if (is_stated && material.Get(AI_MATKEY_COLOR_DIFFUSE, found) != AI_SUCCESS) return std::nullopt;
    if (has_texture && found.r == 0 && found.g == 0 && found.b == 0) found = aiColor4D(1, 1, 1, 1);
    found.a = 1.0f;
    material.Get(AI_MATKEY_OPACITY, found.a);
    if (found.a == 0.0f) {
      warnings_.push_back(fmt::format("material '{}' is fully transparent; it is taken for opaque", name));
      found.a = 1.0f;
    }
  }
  const Eigen::Vector4f color(found.r, found.g, found.b, found.a);
  if (!color.allFinite()) return std::nullopt;
  return color.cwiseMax(0.0f).cwiseMin(1.0f);
}

std::shared_ptr<const Texture> MeshMaterials::read_texture(const std::string& path) {
  if (const auto known = textures_.find(path); known != textures_.end()) return known->second;
  Result<Texture> texture = decode(path);
  if (!texture) {
    const Diagnostic& why = texture.errors().front();
    warnings_.push_back(fmt::format("its texture '{}' can't be used: {}{}", path, why.message,
                                    why.hint.empty() ? "" : " (" + why.hint + ")"));
    return textures_[path] = nullptr;
  }
  texture->file = path;
  return textures_[path] = std::make_shared<const Texture>(*std::move(texture));
}

Result<Texture> MeshMaterials::decode(const std::string& path) {
  if (const aiTexture* embedded = scene_.GetEmbeddedTexture(path.c_str())) return decode_embedded(*embedded);
  const std::string* bytes = input_.named(path);
  if (bytes == nullptr) return error("it isn't there, beside the mesh");
  return decode_texture(*bytes);
}

}  // namespace rehearse
