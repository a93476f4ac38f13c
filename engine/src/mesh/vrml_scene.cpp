#include "vrml_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/text.h"
#include "mesh_format.h"
#include "picture_file.h"
#include "polygon_mesh.h"
#include "vrml_tree.h"

namespace rehearse {
namespace {

constexpr int max_inlines = 10;         // within each other
constexpr int max_nodes = 1'000'000;    // visited: a node that is used several times counts each time
constexpr std::size_t max_colors = 64;  // of a Shape
constexpr std::size_t max_names = 100;  // of nodes, for a message

Eigen::Vector3d vector_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

Eigen::Affine3d rotation_of(const std::vector<double>& v) {
  const Eigen::Vector3d axis(v[0], v[1], v[2]);
  if (axis.norm() < 1e-12) return Eigen::Affine3d::Identity();
  return Eigen::Affine3d(Eigen::AngleAxisd(v[3], axis.stableNormalized()));
}

/// T C R SR S -SR -C of the standard, 6.52.
Eigen::Affine3d transform_of(const VrmlNode& node) {
  const Eigen::Translation3d center(vector_of(node.numbers("center", {0, 0, 0})));
  const Eigen::Affine3d stretch = rotation_of(node.numbers("scaleOrientation", {0, 0, 1, 0}));
  return Eigen::Translation3d(vector_of(node.numbers("translation", {0, 0, 0}))) * center *
         rotation_of(node.numbers("rotation", {0, 0, 1, 0})) * stretch *
         Eigen::Scaling(vector_of(node.numbers("scale", {1, 1, 1}))) * stretch.inverse() * center.inverse();
}

bool is_placed(const VrmlNode& node) { return node.type == "Transform" || node.is_of_proto; }

/// Lists of indices, each ended by -1.
std::vector<std::vector<int>> faces_of(const VrmlNode& node, const char* field) {
  std::vector<std::vector<int>> faces;
  const VrmlValue* value = node.find(field);
  if (value == nullptr) return faces;
  std::vector<int> face;
  for (const double number : value->numbers) {
    const int index = std::abs(number) < 1e9 ? static_cast<int>(number) : std::numeric_limits<int>::max();
    if (index >= 0) {
      face.push_back(index);
    } else {
      faces.push_back(std::move(face));
      face.clear();
    }
  }
  if (!face.empty()) faces.push_back(std::move(face));
  return faces;
}

template <class Vector>
std::vector<Vector> points_of(const VrmlNode* node, const char* field) {
  constexpr auto size = static_cast<std::size_t>(Vector::SizeAtCompileTime);
  std::vector<Vector> points;
  const VrmlValue* value = node == nullptr ? nullptr : node->find(field);
  for (std::size_t i = 0; value != nullptr && i + size <= value->numbers.size(); i += size)
    points.push_back(Eigen::Map<const Vector>(value->numbers.data() + i));
  return points;
}

/// The colour of each face, by `colorPerVertex`; empty: the geometry states none.
std::vector<Eigen::Vector3d> colors_of_faces(const VrmlNode& geometry, const std::vector<std::vector<int>>& faces) {
  const std::vector<Eigen::Vector3d> colors = points_of<Eigen::Vector3d>(geometry.node("color"), "color");
  std::vector<Eigen::Vector3d> of_faces;
  if (colors.empty()) return of_faces;
  const auto color = [&colors](int i) {
    return colors[static_cast<std::size_t>(std::clamp(i, 0, static_cast<int>(colors.size()) - 1))];
  };
  const VrmlValue* indices = geometry.find("colorIndex");
  const bool per_vertex = geometry.numbers("colorPerVertex", {1.0})[0] != 0.0;
  const auto lists = per_vertex && indices != nullptr ? faces_of(geometry, "colorIndex") : faces;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!per_vertex) {
      const bool has_index = indices != nullptr && i < indices->numbers.size();
      of_faces.push_back(color(has_index ? static_cast<int>(indices->numbers[i]) : static_cast<int>(i)));
      continue;
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const std::vector<int>& list = i < lists.size() && !lists[i].empty() ? lists[i] : faces[i];
    for (const int index : list) sum += color(index);
    of_faces.push_back(list.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(list.size())));
  }
  return of_faces;
}

class SceneReader {
 public:
  SceneReader(MeshInput& input, const MeshSelection& selection, std::vector<std::string>& warnings)
      : input_(input), selection_(selection), warnings_(warnings), is_within_(selection.node.empty()) {}

  void read_all(const std::vector<VrmlNodePtr>& nodes, const Eigen::Affine3d& place) {
    for (const VrmlNodePtr& node : nodes) read(*node, place);
  }

  std::optional<Diagnostic> problem;
  std::vector<MeshPart> parts;
  bool found_node = false;
  std::vector<std::string> names;  // of the nodes, in the order of the tree

 private:
  void read(const VrmlNode& node, const Eigen::Affine3d& place) {
    if (problem || (found_node && !is_within_)) return;
    if (is_within_ && selection_.without.count(node.name) != 0) return;
    if (!node.name.empty() && std::ranges::find(names, node.name) == names.end() && names.size() < max_names)
      names.push_back(node.name);
    if (++count_ > max_nodes) return fail(node, "its nodes unfold to more than a million");
    const bool is_selected = !is_within_ && node.name == selection_.node;
    is_within_ = is_within_ || is_selected;
    found_node = found_node || is_selected;
    Eigen::Affine3d here = is_placed(node) ? place * transform_of(node) : place;
    if (is_selected) here.translation().setZero();  // as in Choreonoid: only rotations and scales remain
    if (node.type == "Inline")
      read_inline(node, here);
    else if (node.type == "Shape" && is_within_)
      read_shape(node, here);
    else
      read_all(children_of(node), here);
    if (is_selected) is_within_ = false;
  }

  void read_inline(const VrmlNode& node, const Eigen::Affine3d& place) {
    const VrmlValue* urls = node.find("url");
    if (urls == nullptr || urls->texts.empty()) return;
    const std::string& url = urls->texts.front();
    const std::filesystem::path file = folder_ / url;
    if (inlines_ >= max_inlines) return fail(node, "its Inline nodes nest too deep");
    const std::string* bytes = input_.named(file.string());
    if (bytes == nullptr) return fail(node, fmt::format("its Inline {} can't be read", in_quotes(url)));
    const Result<std::vector<VrmlNodePtr>> nodes = parse_vrml(*bytes);
    if (!nodes)
      return fail(node, fmt::format("its Inline {}: line {}: {}", in_quotes(url), nodes.errors().front().line,
                                    nodes.errors().front().message));
    const std::filesystem::path before = std::exchange(folder_, file.parent_path());
    ++inlines_;
    read_all(*nodes, place);
    --inlines_;
    folder_ = before;
  }

  void read_shape(const VrmlNode& node, const Eigen::Affine3d& place) {
    const VrmlNode* geometry = node.node("geometry");
    if (geometry == nullptr) return;
    Result<PolygonMesh> polygons = polygons_of(*geometry);
    if (!polygons) return fail(*geometry, polygons.errors().front().message);
    leave_out_impossible(*polygons);
    if (polygons->faces.empty()) return;
    const VrmlNode* appearance = node.node("appearance");
    MeshPart paint;
    if (appearance != nullptr) read_appearance(*appearance, paint);
    const auto colors = colors_of_faces(*geometry, polygons->faces);
    std::map<std::array<int, 3>, PolygonMesh> by_color;
    split(*polygons, colors, by_color);
    for (const auto& [shade, some] : by_color) {
      if (some.faces.size() > max_mesh_triangles - triangles_) return fail(*geometry, "it has too many triangles");
      Result<MeshPart> part = part_of(some, place);
      if (!part && part.errors().front().message == "it has no triangles") continue;
      if (!part) return fail(*geometry, part.errors().front().message);
      triangles_ += part->triangles.size();
      part->object = object_;
      part->color = paint.color;
      if (!colors.empty())
        part->color = Eigen::Vector4f(shade[0] / 255.0f, shade[1] / 255.0f, shade[2] / 255.0f, opacity_of(paint));
      if (!part->texture_coordinates.empty()) part->texture = paint.texture;
      if (part->texture == nullptr) part->texture_coordinates.clear();
      parts.push_back(*std::move(part));
    }
    if (!parts.empty()) object_ = parts.back().object + 1;
  }

  /// As in Choreonoid, faces with corners that don't exist are left out.
  void leave_out_impossible(PolygonMesh& polygons) {
    if (!polygons.texture_faces.empty() && polygons.texture_faces != polygons.faces) return;  // they are parallel
    const auto count = static_cast<int>(polygons.vertices.size());
    const auto is_impossible = [count](const std::vector<int>& face) {
      return std::ranges::any_of(face, [count](int corner) { return corner >= count; });
    };
    const std::size_t left_out = std::erase_if(polygons.faces, is_impossible);
    if (polygons.texture_coordinates.size() == polygons.vertices.size())
      std::erase_if(polygons.texture_faces, is_impossible);
    if (left_out > 0)
      warnings_.push_back(fmt::format("{} faces refer to vertices that don't exist; they are left out", left_out));
  }

  static float opacity_of(const MeshPart& paint) { return paint.color ? (*paint.color)[3] : 1.0f; }

  /// The faces by colour; all together if the geometry states none. Faces of too many colours get coarser ones.
  static void split(const PolygonMesh& polygons, const std::vector<Eigen::Vector3d>& colors,
                    std::map<std::array<int, 3>, PolygonMesh>& by_color) {
    if (colors.empty()) {
      by_color[{}] = polygons;
      return;
    }
    for (int step = 1; step <= 256; step *= 2) {
      by_color.clear();
      for (std::size_t i = 0; i < polygons.faces.size(); ++i) {
        std::array<int, 3> shade{};
        for (int k = 0; k < 3; ++k)
          shade[static_cast<std::size_t>(k)] = std::min(
              255, static_cast<int>(std::lround(std::clamp(colors[i][k], 0.0, 1.0) * 255.0)) / step * step + step / 2);
        const auto [known, is_new] = by_color.try_emplace(shade);
        if (is_new) {
          known->second.vertices = polygons.vertices;
          known->second.texture_coordinates = polygons.texture_coordinates;
          known->second.crease_angle = polygons.crease_angle;
        }
        known->second.faces.push_back(polygons.faces[i]);
        if (i < polygons.texture_faces.size()) known->second.texture_faces.push_back(polygons.texture_faces[i]);
        if (by_color.size() > max_colors) break;
      }
      if (by_color.size() <= max_colors) return;
    }
  }

  void read_appearance(const VrmlNode& appearance, MeshPart& paint) {
    if (const VrmlNode* material = appearance.node("material")) {
      const auto diffuse = material->numbers("diffuseColor", {0.8, 0.8, 0.8});
      const double transparency = material->numbers("transparency", {0.0})[0];
      paint.color = Eigen::Vector4d(diffuse[0], diffuse[1], diffuse[2], 1.0 - transparency)
                        .cwiseMax(0.0)
                        .cwiseMin(1.0)
                        .cast<float>();
    }
    const VrmlNode* texture = appearance.node("texture");
    const VrmlValue* url = texture == nullptr ? nullptr : texture->find("url");
    if (url == nullptr || url->texts.empty()) return;
    const std::string name = (folder_ / url->texts.front()).string();
    const auto [known, is_new] = textures_.try_emplace(name);
    if (is_new) {
      const std::string* bytes = input_.named(name);
      Result<Texture> picture = bytes == nullptr ? Result<Texture>(error("it can't be read")) : decode_texture(*bytes);
      if (picture) {
        picture->file = name;
        known->second = std::make_shared<const Texture>(*std::move(picture));
      } else {
        warnings_.push_back(fmt::format("its texture {}: {}", in_quotes(name), picture.errors().front().message));
      }
    }
    paint.texture = known->second;
  }

  static Result<PolygonMesh> polygons_of(const VrmlNode& node) {
    const auto number = [&node](const char* field, double otherwise) { return node.numbers(field, {otherwise})[0]; };
    if (node.type == "Box") return box_polygons(vector_of(node.numbers("size", {2, 2, 2})));
    if (node.type == "Sphere") return sphere_polygons(number("radius", 1.0));
    if (node.type == "Cylinder") return cylinder_polygons(number("radius", 1.0), number("height", 2.0));
    if (node.type == "Cone") return cone_polygons(number("bottomRadius", 1.0), number("height", 2.0));
    if (node.type == "IndexedFaceSet") return face_set_of(node);
    if (node.type == "Extrusion") return extrusion_of(node);
    if (node.type != "ElevationGrid") return PolygonMesh();  // lines, points, text
    const auto count = [&number](const char* field) {
      return static_cast<int>(std::clamp(number(field, 0), 0.0, 1e5));
    };
    ElevationGrid grid{count("xDimension"), count("zDimension"), number("xSpacing", 1), number("zSpacing", 1), {}, 0.0};
    if (const VrmlValue* heights = node.find("height")) grid.heights = heights->numbers;
    grid.crease_angle = number("creaseAngle", 0.0);
    return elevation_polygons(grid);
  }

  static PolygonMesh face_set_of(const VrmlNode& node) {
    PolygonMesh mesh;
    mesh.vertices = points_of<Eigen::Vector3d>(node.node("coord"), "point");
    mesh.faces = faces_of(node, "coordIndex");
    mesh.texture_coordinates = points_of<Eigen::Vector2d>(node.node("texCoord"), "point");
    if (!mesh.texture_coordinates.empty()) mesh.texture_faces = faces_of(node, "texCoordIndex");
    if (!mesh.texture_coordinates.empty() && mesh.texture_faces.empty()) mesh.texture_faces = mesh.faces;
    mesh.crease_angle = node.numbers("creaseAngle", {0.0})[0];
    if (node.numbers("ccw", {1.0})[0] != 0.0) return mesh;
    for (auto* faces : {&mesh.faces, &mesh.texture_faces})
      for (std::vector<int>& face : *faces) std::ranges::reverse(face);
    return mesh;
  }

  static Result<PolygonMesh> extrusion_of(const VrmlNode& node) {
    Extrusion extrusion;
    if (node.find("crossSection") != nullptr) extrusion.section = points_of<Eigen::Vector2d>(&node, "crossSection");
    if (node.find("spine") != nullptr) extrusion.spine = points_of<Eigen::Vector3d>(&node, "spine");
    extrusion.scales = points_of<Eigen::Vector2d>(&node, "scale");
    for (const Eigen::Vector4d& turn : points_of<Eigen::Vector4d>(&node, "orientation"))
      extrusion.orientations.push_back(rotation_of({turn[0], turn[1], turn[2], turn[3]}).linear());
    extrusion.begin_cap = node.numbers("beginCap", {1.0})[0] != 0.0;
    extrusion.end_cap = node.numbers("endCap", {1.0})[0] != 0.0;
    extrusion.crease_angle = node.numbers("creaseAngle", {0.0})[0];
    return extrusion_polygons(extrusion);
  }

  void fail(const VrmlNode& node, std::string message) {
    problem = error(std::move(message));
    if (inlines_ == 0) problem->line = node.line;
  }

  MeshInput& input_;
  const MeshSelection& selection_;
  std::vector<std::string>& warnings_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;  // by name; null: unreadable, already reported
  std::filesystem::path folder_;                                    // of the present file, relative to the mesh
  bool is_within_;                                                  // the selected node
  int inlines_ = 0;
  int count_ = 0;
  int object_ = 0;
  std::size_t triangles_ = 0;
};

}  // namespace

Result<std::vector<MeshPart>> read_vrml_parts(MeshInput& input, const MeshSelection& selection,
                                              const Eigen::Vector3d& scale, std::vector<std::string>& warnings) {
  const std::vector<VrmlNodePtr> nodes = REHEARSE_TRY(parse_vrml(input.bytes()));
  SceneReader reader(input, selection, warnings);
  reader.read_all(nodes, Eigen::Affine3d(Eigen::Scaling(scale)));
  if (reader.problem) return *reader.problem;
  if (!selection.node.empty() && !reader.found_node) return no_such_node(selection.node, reader.names);
  if (reader.parts.empty()) return error("it has no triangles");
  return std::move(reader.parts);
}

}  // namespace rehearse
