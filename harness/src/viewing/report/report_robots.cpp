#include "report_robots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/body.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;

const Color default_color(0.72f, 0.72f, 0.74f, 1.0f);  // as in recorded pictures
constexpr double marker_size = 0.02;                   // size of the marker for a missing mesh [m]

ReportJson pose_json(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d& p = pose.translation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

ReportJson vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
ReportJson color_json(const Color& c) { return {c[0], c[1], c[2], c[3]}; }

bool lacks_meshes(const Model& model) {
  return std::ranges::any_of(model.links, [](const Link& link) {
    const auto lacks_mesh = [](const Shape& shape) {
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      return mesh && !mesh->data;
    };
    return std::ranges::any_of(link.visuals, lacks_mesh) || std::ranges::any_of(link.collisions, lacks_mesh);
  });
}

std::string text_of(const mcap::Attachment* attachment) {
  return attachment ? std::string(attachment->text()) : std::string();
}

/// The folder itself and all folders above it.
std::vector<fs::path> folders_above(const fs::path& folder) {
  std::vector<fs::path> folders;
  std::error_code ignored;
  for (fs::path at = fs::absolute(folder, ignored).lexically_normal();; at = at.parent_path()) {
    folders.push_back(at);
    if (!at.has_relative_path()) return folders;
  }
}

/// The model's file that a recording names relative to its scenario. It is searched beside that scenario, or beside the
/// scenarios of a repository that contains the recording or the working directory.
std::optional<fs::path> find_model(const fs::path& scenario_file, const fs::path& recording, const std::string& model) {
  std::vector<fs::path> folders;
  if (!scenario_file.empty()) {
    folders.push_back(scenario_file.parent_path());
  } else {
    for (const fs::path& start : {recording.parent_path(), fs::path(".")})
      for (const fs::path& above : folders_above(start))
        for (const char* usual : {"fixtures/scenarios", "scenarios", "."}) folders.push_back(above / usual);
  }
  std::error_code ignored;
  for (const fs::path& folder : folders)
    if (const fs::path file = folder / model; fs::is_regular_file(file, ignored)) return file;
  return std::nullopt;
}

/// The colour of a texture at a vertex.
Color texel(const Texture& texture, const Eigen::Vector2f& at) {
  const auto place = [](float share, int size) {
    const float inside = share - std::floor(share);  // textures repeat
    return std::clamp(static_cast<int>(inside * static_cast<float>(size)), 0, size - 1);
  };
  const auto x = static_cast<std::size_t>(place(at.x(), texture.width));
  const auto y = static_cast<std::size_t>(texture.height - 1 - place(at.y(), texture.height));
  const std::size_t pixel = 4 * (y * static_cast<std::size_t>(texture.width) + x);
  Color color;
  for (int i = 0; i < 4; ++i) color[i] = static_cast<float>(texture.rgba[pixel + static_cast<std::size_t>(i)]) / 255.0f;
  return color;
}

void append_colors(std::vector<std::uint8_t>& colors, const MeshPart& part, const Color& plain) {
  const bool textured = part.texture && part.texture_coordinates.size() == part.vertices.size() &&
                        part.texture->width > 0 && part.texture->height > 0;
  for (std::size_t i = 0; i < part.vertices.size(); ++i) {
    Color color = plain;
    if (textured) color = color.cwiseProduct(texel(*part.texture, part.texture_coordinates[i]));
    for (int k = 0; k < 4; ++k)
      colors.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(color[k], 0.0f, 1.0f))));
  }
}

}  // namespace

void RobotWriter::write(const Scenario& scenario) {
  for (const ScenarioBody& body : scenario.bodies) write_body(body);
}

/// The recorded model with the meshes of this machine; null: it can't be loaded.
std::shared_ptr<const Model> RobotWriter::with_meshes(const ScenarioBody& body) {
  if (body.model_file.empty() || !lacks_meshes(*body.model)) return body.model;
  const auto file = find_model(scenario_file_, run_.file, body.model_file);
  if (!file) return body.model;
  UrdfOptions options;
  options.allow_missing_meshes = true;
  options.allow_unknown_devices = true;
  options.allow_unsupported = true;
  options.fixed_root = body.fixed;
  options.kinematic = body.kinematic;
  for (const auto& [name, folder] : body.packages) options.packages[name] = file->parent_path() / folder;
  auto model = parse_model(text_of(run_.trace.find_attachment(body.model_file)), file->string(), options);
  return model ? std::make_shared<const Model>(*std::move(model)) : body.model;
}

/// Compares the mesh with its digest in the recording.
bool RobotWriter::is_as_recorded(const ScenarioBody& body, const Mesh& mesh) const {
  if (mesh.heightmap) return true;
  const std::string digests = text_of(run_.trace.find_attachment(body.model_file + ".meshes"));
  if (digests.empty() || mesh.file.empty()) return true;
  return digests.find(fmt::format("{}  {}\n", mesh.data->digest, mesh.file)) != std::string::npos;
}

void RobotWriter::write_body(const ScenarioBody& body) {
  missing_.clear();
  changed_.clear();
  const std::shared_ptr<const Model> drawn = with_meshes(body);
  ReportJson links = ReportJson::array();
  for (std::size_t i = 0; i < body.model->links.size(); ++i) {
    const Link& link = body.model->links[i];
    const int same = drawn->find_link(link.name);  // a missing mesh removes no link
    links.push_back(
        link_json(body, link, same < 0 ? link : drawn->links[static_cast<std::size_t>(same)], static_cast<int>(i)));
  }
  robots_.push_back({{"name", body.name}, {"links", std::move(links)}});
  const auto tell = [&](const std::set<std::string>& meshes, const char* what) {
    if (meshes.empty()) return;
    constexpr std::size_t named = 3;
    std::vector<std::string> names(meshes.begin(), meshes.end());
    const bool more = names.size() > named;
    if (more) names.resize(named);
    omitted_.push_back(fmt::format("{} {} of {} {}: {}{}.", meshes.size(), meshes.size() == 1 ? "mesh" : "meshes",
                                   body.name, what, fmt::join(names, ", "), more ? ", ..." : ""));
  };
  tell(missing_, "can't be found on this machine, and simpler shapes are drawn instead");
  tell(changed_, "changed after the recording, and the present shapes are drawn");
}

/// The names of the seven series of a link's pose; null: no series moves the link.
ReportJson RobotWriter::pose_series(const ScenarioBody& body, const Link& link) {
  const std::string topic = ChannelName::of_owner(body.name, link.name, ChannelKind::pose).topic();
  const TraceChannel* channel = run_.trace.find_channel(topic);
  if (!channel || run_.of(*channel).messages == 0) return nullptr;
  ReportJson names = ReportJson::array();
  for (const char* element :
       {"position/x", "position/y", "position/z", "orientation/x", "orientation/y", "orientation/z", "orientation/w"}) {
    const std::size_t column = column_of(*channel, element);
    if (column == channel->columns.size()) return nullptr;
    names.push_back(channel->columns[column].series);
  }
  topics_.insert(topic);
  return names;
}

ReportJson RobotWriter::joint_json(const ScenarioBody& body, const Link& link) {
  const Joint& joint = link.joint;
  const bool turns = joint.type == JointType::revolute || joint.type == JointType::continuous;
  const bool slides = joint.type == JointType::prismatic;
  ReportJson q, q0 = 0.0;
  const std::string topic = ChannelName::of_body(body.name, ChannelKind::joints).topic();
  if (turns || slides) {
    if (const TraceChannel* channel = run_.trace.find_channel(topic); channel && run_.of(*channel).messages > 0) {
      const std::size_t column = column_of(*channel, joint.name + "/q");
      if (column < channel->columns.size()) {
        q = channel->columns[column].series;
        topics_.insert(topic);
      }
    }
    const auto id = static_cast<std::size_t>(joint.id);
    if (joint.id >= 0 && id < body.joints.size()) q0 = body.joints[id];
  }
  return {{"type", turns    ? "revolute"
                   : slides ? "prismatic"
                            : "fixed"},
          {"axis", vector_json(joint.axis)},
          {"q", std::move(q)},
          {"q0", std::move(q0)}};
}

ReportJson RobotWriter::link_json(const ScenarioBody& body, const Link& link, const Link& drawn, int index) {
  ReportJson json{{"name", link.name}, {"parent", link.parent}};
  if (index == 0) {
    json["joint"] = nullptr;
    json["offset"] = pose_json(Eigen::Isometry3d::Identity());
    ReportJson series = body.fixed ? ReportJson() : pose_series(body, link);
    if (series.is_null()) {
      Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
      root.translate(body.position).rotate(body.rotation);
      json["fixed"] = pose_json(root);
    }
    json["pose"] = std::move(series);
  } else {
    json["joint"] = joint_json(body, link);
    json["offset"] = pose_json(link.joint.origin);
    if (link.joint.type == JointType::free) json["pose"] = pose_series(body, link);
  }
  json["shapes"] = shapes_json(body, drawn);
  return json;
}

/// The visual shapes of a link. Missing meshes are replaced by its collision shapes, or else by a marker.
ReportJson RobotWriter::shapes_json(const ScenarioBody& body, const Link& link) {
  ReportJson shapes = ReportJson::array();
  bool is_complete = true;
  for (const Shape& shape : link.visuals) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (mesh && !mesh->data) {
      missing_.insert(mesh->file);
      is_complete = false;
      continue;
    }
    if (mesh && !is_as_recorded(body, *mesh)) changed_.insert(mesh->file);
    add_shape(shapes, shape);
  }
  if (is_complete) return shapes;
  const std::size_t before = shapes.size();
  for (const Shape& shape : link.collisions) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (!mesh || mesh->data) add_shape(shapes, shape);
  }
  if (shapes.size() == before)
    add_shape(shapes, {"", Box{Eigen::Vector3d::Constant(marker_size)}, Eigen::Isometry3d::Identity(), {}, {}});
  return shapes;
}

void RobotWriter::add_shape(ReportJson& shapes, const Shape& shape) {
  const Color color = shape.color.value_or(default_color);
  const auto add = [&](const Eigen::Isometry3d& pose) -> ReportJson& {
    shapes.push_back({{"pose", pose_json(pose)}, {"color", color_json(color)}});
    return shapes.back();
  };
  if (const auto* box = std::get_if<Box>(&shape.geometry)) {
    add(shape.pose)["box"] = vector_json(box->size);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    add(shape.pose)["sphere"] = sphere->radius;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.geometry)) {
    add(shape.pose)["cylinder"] = {{"radius", cylinder->radius}, {"length", cylinder->length}};
  } else if (const auto* capsule = std::get_if<Capsule>(&shape.geometry)) {
    add(shape.pose)["cylinder"] = {{"radius", capsule->radius}, {"length", capsule->length}};
    for (const double side : {-0.5, 0.5}) {
      Eigen::Isometry3d cap = shape.pose;
      cap.translate(Eigen::Vector3d(0.0, 0.0, side * capsule->length));
      add(cap)["sphere"] = capsule->radius;
    }
  } else {
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    ReportJson& added = add(shape.pose);
    added["mesh"] = mesh_of(*mesh.data, shape);
    added["scale"] = {1.0, 1.0, 1.0};  // the vertices are already scaled
  }
  if (shape.checker)
    shapes.back()["checker"] = {{"color", color_json(shape.checker->color)}, {"size", shape.checker->size}};
}

/// The index of a mesh in the report. A mesh with colours of its own is a separate mesh for each colour of a shape.
int RobotWriter::mesh_of(const MeshData& mesh, const Shape& shape) {
  const bool has_colors =
      std::ranges::any_of(mesh.parts, [](const MeshPart& part) { return part.color || part.texture; });
  std::vector<float> shade;
  if (has_colors && shape.color) shade.assign(shape.color->data(), shape.color->data() + shape.color->size());
  const std::vector<double> corners{mesh.lower.x(), mesh.lower.y(), mesh.lower.z(),
                                    // A file with two scales is two meshes.
                                    mesh.upper.x(), mesh.upper.y(), mesh.upper.z()};
  const auto [known, is_new] =
      known_meshes_.try_emplace({mesh.digest + mesh.file, shade, corners}, static_cast<int>(meshes_.size()));
  if (!is_new) return known->second;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> colors;
  for (const MeshPart& part : mesh.parts) {
    const auto first = static_cast<std::uint32_t>(positions.size() / 3);
    for (const Eigen::Vector3f& vertex : part.vertices)
      positions.insert(positions.end(), vertex.data(), vertex.data() + 3);
    for (const auto& triangle : part.triangles)
      for (const std::uint32_t corner : triangle) indices.push_back(first + corner);
    if (has_colors) append_colors(colors, part, color_of(part, shape, default_color));
  }
  ReportJson json{{"positions", blobs_.array(array_of(std::span<const float>(positions)))},
                  {"indices", blobs_.array(array_of(std::span<const std::uint32_t>(indices)))}};
  if (has_colors) json["color"] = blobs_.array({"u8", 1, std::move(colors)});
  meshes_.push_back(std::move(json));
  return known->second;
}

}  // namespace rehearse
