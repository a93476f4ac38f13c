#include "mesh_scene.h"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "mesh/mesh_part.h"

namespace rehearse {
namespace {

MeshMatrix matrix_of(const aiMatrix4x4& m) {
  return (MeshMatrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4).finished();
}

std::string name_text(const aiString& text) { return {text.data, text.length}; }

Eigen::Vector3d vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// The transform of normals, up to their length, if vertices are transformed by `linear`: its cofactors, which exist
/// even if it flattens. A mirror reverses the winding, so the normals are reversed, too.
Eigen::Matrix3d normal_matrix(const Eigen::Matrix3d& linear) {
  Eigen::Matrix3d cofactors;
  for (int i = 0; i < 3; ++i) cofactors.col(i) = linear.col((i + 1) % 3).cross(linear.col((i + 2) % 3));
  return linear.determinant() < 0.0 ? Eigen::Matrix3d(-cofactors) : cofactors;
}

/// Sets the triangles' normals at vertices without a usable normal in the file; those are zero so far.
void mend_normals(MeshPart& part) {
  for (const auto& triangle : part.triangles) {
    for (const std::uint32_t corner : triangle) {
      Eigen::Vector3f& normal = part.normals[corner];
      if (normal.isZero(0.0f)) normal = normal_of(part, triangle);
    }
  }
  for (Eigen::Vector3f& normal : part.normals) {  // of vertices that belong to no triangle
    if (normal.isZero(0.0f)) normal = Eigen::Vector3f::UnitZ();
  }
}

void read_normals(const aiMesh& mesh, const MeshMatrix& place, MeshPart& part) {
  const Eigen::Matrix3d turn = normal_matrix(place.leftCols<3>());
  part.normals.reserve(mesh.mNumVertices);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const Eigen::Vector3d normal = (turn * vector_of(mesh.mNormals[i])).stableNormalized();
    part.normals.push_back(normal.allFinite() ? Eigen::Vector3f(normal.cast<float>()) : Eigen::Vector3f::Zero());
  }
  mend_normals(part);
}

std::optional<Diagnostic> read_triangles(const aiMesh& mesh, bool is_mirrored, MeshPart& part) {
  part.triangles.reserve(mesh.mNumFaces);
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) return error(fmt::format("a face of it has {} corners", face.mNumIndices));
    std::array<std::uint32_t, 3> triangle{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
    for (const std::uint32_t corner : triangle) {
      if (corner < mesh.mNumVertices) continue;
      return error(fmt::format("a face of it refers to vertex {}, and there are {}", corner, mesh.mNumVertices));
    }
    if (is_mirrored) std::swap(triangle[1], triangle[2]);
    part.triangles.push_back(triangle);
  }
  return std::nullopt;
}

/// The triangles of one of assimp's meshes, transformed by `place`.
Result<MeshPart> read_part(const aiMesh& mesh, const MeshMatrix& place, bool wants_flat, const Paint& paint) {
  MeshPart part;
  part.vertices.reserve(mesh.mNumVertices);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i)
    if (!add_vertex(place, vector_of(mesh.mVertices[i]), part)) return not_finite();
  part.color = paint.color;
  part.has_default_color = paint.is_default;
  if (mesh.HasTextureCoords(paint.channel)) {
    part.texture = paint.texture;
    part.texture_coordinates.reserve(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& uv = mesh.mTextureCoords[paint.channel][i];
      part.texture_coordinates.emplace_back(uv.x, uv.y);
      if (!part.texture_coordinates.back().allFinite()) return error("a texture coordinate of it isn't finite");
    }
  }
  if (auto problem = read_triangles(mesh, mirrors(place), part)) return *problem;
  if (wants_flat || !mesh.HasNormals()) {
    flatten(part);
  } else {
    read_normals(mesh, place, part);
  }
  return part;
}

template <class Item>
void append(std::vector<Item>& to, const std::vector<Item>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

class PartReader {
 public:
  PartReader(const aiScene& scene, MeshFormat format, const MeshMaterials& materials)
      : scene_(scene), format_(format), materials_(materials) {}

  /// Adds the meshes of a node; with a name only the first mesh of that name. An error if one of them can't be used.
  std::optional<Diagnostic> read(const aiNode& node, const MeshMatrix& place, const std::string* only = nullptr) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      if (node.mMeshes[i] >= scene_.mNumMeshes) return error("a node of it refers to a mesh that isn't there");
      if (only != nullptr && *only != name_text(scene_.mMeshes[node.mMeshes[i]]->mName)) continue;
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;  // lines and points
      count_ += mesh.mNumFaces;
      if (count_ > max_mesh_triangles) return error(fmt::format("it has more than {} triangles", max_mesh_triangles));
      Result<MeshPart> part = read_part(mesh, place, format_ == MeshFormat::stl, materials_[mesh.mMaterialIndex]);
      if (!part) return part.errors().front();
      add(*std::move(part), mesh.mMaterialIndex);
    }
    if (format_ == MeshFormat::obj && !parts_.empty()) object_ = parts_.back().object + 1;
    return std::nullopt;
  }

  std::vector<MeshPart> take() { return std::move(parts_); }

 private:
  /// Appends to the part of the same object and material, if there is one: fewer parts are drawn faster.
  void add(MeshPart part, unsigned material) {
    part.object = object_;
    const auto key = std::tuple(object_, material, part.texture_coordinates.empty());
    const auto [known, is_new] = indices_.emplace(key, parts_.size());
    if (is_new) {
      parts_.push_back(std::move(part));
      return;
    }
    MeshPart& whole = parts_[known->second];
    const auto shift = static_cast<std::uint32_t>(whole.vertices.size());
    append(whole.vertices, part.vertices);
    append(whole.normals, part.normals);
    append(whole.texture_coordinates, part.texture_coordinates);
    for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({a + shift, b + shift, c + shift});
  }

  const aiScene& scene_;
  MeshFormat format_;
  const MeshMaterials& materials_;
  std::vector<MeshPart> parts_;
  std::map<std::tuple<int, unsigned, bool>, std::size_t> indices_;  // into parts_
  std::size_t count_ = 0;                                           // of triangles
  int object_ = 0;
};

bool has_mesh(const aiScene& scene, const aiNode& node, const std::string& name) {
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    if (node.mMeshes[i] < scene.mNumMeshes && name_text(scene.mMeshes[node.mMeshes[i]]->mName) == name) return true;
  return false;
}

/// The names of all nodes in the order of the tree, each once.
std::vector<std::string> names_of_nodes(const aiScene& scene) {
  std::vector<std::string> names;
  std::vector<const aiNode*> waiting{scene.mRootNode};
  while (!waiting.empty()) {
    const aiNode& node = *waiting.back();
    waiting.pop_back();
    const std::string name = name_text(node.mName);
    if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    for (unsigned i = node.mNumChildren; i-- > 0;) waiting.push_back(node.mChildren[i]);
  }
  return names;
}

/// A node that is still to be read.
struct Waiting {
  const aiNode* node;
  MeshMatrix parent;  // from the parent node's frame to the shape's
  bool is_within;     // the selected node
};

}  // namespace

bool has_node(const aiScene& scene, const std::string& name) {
  std::vector<const aiNode*> waiting;
  if (scene.mRootNode != nullptr) waiting.push_back(scene.mRootNode);
  while (!waiting.empty()) {
    const aiNode& node = *waiting.back();
    waiting.pop_back();
    if (name_text(node.mName) == name || has_mesh(scene, node, name)) return true;
    for (unsigned i = 0; i < node.mNumChildren; ++i) waiting.push_back(node.mChildren[i]);
  }
  return false;
}

Result<std::vector<MeshPart>> read_parts(const aiScene& scene, MeshFormat format, const MeshMaterials& materials,
                                         const Eigen::Vector3d& scale, const MeshSelection& selection) {
  if (scene.mRootNode == nullptr) return error("it has no triangles");
  bool found = selection.node.empty();
  PartReader reader(scene, format, materials);
  std::vector<Waiting> waiting{// a stack instead of recursion, because a file may nest nodes to any depth
                               {scene.mRootNode, placing_of(format, scale, selection.z_up), found}};
  while (!waiting.empty()) {
    auto [node, parent, is_within] = waiting.back();
    waiting.pop_back();
    const std::string name = name_text(node->mName);
    if (is_within && selection.without.contains(name)) continue;
    MeshMatrix place = product(parent, matrix_of(node->mTransformation));
    if (!is_within && !found && (name == selection.node || has_mesh(scene, *node, selection.node))) {
      const bool is_whole = name == selection.node;
      found = true;
      MeshMatrix turned = place;  // as in Choreonoid: only rotations and scales remain
      if (node != scene.mRootNode) turned.col(3).setZero();
      if (!is_whole) {
        if (auto problem = reader.read(*node, turned, &selection.node)) return *problem;
        break;
      }
      waiting.clear();
      is_within = true;
      place = turned;
    }
    if (is_within)
      if (auto problem = reader.read(*node, place)) return *problem;
    for (unsigned i = node->mNumChildren; i-- > 0;) waiting.push_back({node->mChildren[i], place, is_within});
  }
  if (!found) return no_such_node(selection.node, names_of_nodes(scene));
  std::vector<MeshPart> parts = reader.take();
  if (parts.empty()) return error("it has no triangles");
  return parts;
}

}  // namespace rehearse
