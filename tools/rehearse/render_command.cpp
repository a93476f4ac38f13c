// rehearse render: draws a picture of a scenario at its start, or of a model.
#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/renderer.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/replaceable.h"
#include "base/write_hint.h"
#include "command.h"
#include "core/simulation/viewpoint.h"
#include "model_scenario.h"
#include "options.h"
#include "output.h"
#include "output_file.h"
#include "picture/picture.h"
#include "scenario_text.h"

namespace rehearse::tool {
namespace {

constexpr int largest_side = Renderer::max_size / 3;  // of a fine picture [pixels]
constexpr double farthest = 1e4;                      // coordinate of eye and target [m]

struct RenderSettings {
  std::string input;
  std::string picture;
  UrdfOptions urdf;                            // of a model
  bool collision = false;                      // draw the shapes that touch instead of those that are seen
  std::optional<Eigen::Vector3d> eye, target;  // [m]
  Camera camera;
};

/// True if the file is probably XML: the first character that isn't white space is a '<'.
bool is_model(const std::string& file) {
  if (is_model_file(file)) return true;
  std::ifstream stream(file, std::ios::binary);
  char first = 0;
  return (stream >> first) && first == '<';
}

/// Poses of the links at the start of the run.
PlacedModel place(const ScenarioBody& body) {
  const Eigen::Isometry3d root = pose_of(body.position, body.rotation);
  return {body.model, forward_kinematics(*body.model, root, body.joints), body.fixed};
}

/// Colours one after the other.
class Palette {
 public:
  Color next() {
    static const std::array<Color, 8> colors{Color(0.90f, 0.45f, 0.25f, 1.0f), Color(0.30f, 0.60f, 0.85f, 1.0f),
                                             Color(0.55f, 0.75f, 0.30f, 1.0f), Color(0.80f, 0.50f, 0.80f, 1.0f),
                                             Color(0.95f, 0.80f, 0.30f, 1.0f), Color(0.30f, 0.75f, 0.70f, 1.0f),
                                             Color(0.75f, 0.60f, 0.45f, 1.0f), Color(0.60f, 0.60f, 0.90f, 1.0f)};
    return colors[used_++ % colors.size()];
  }

 private:
  std::size_t used_ = 0;
};

/// A hull with flat faces.
MeshPart part_of(const ConvexHull& hull, int object, const Color& color) {
  MeshPart part;
  part.object = object;
  part.color = color;
  for (const std::vector<int>& face : hull.faces) {
    const auto first = static_cast<std::uint32_t>(part.vertices.size());
    const auto corner = [&](std::size_t i) { return hull.vertices[static_cast<std::size_t>(face[i])]; };
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
      normal += (corner(i) - corner(0)).cross(corner(i + 1) - corner(0));
    for (std::size_t i = 0; i < face.size(); ++i) {
      part.vertices.push_back(corner(i).cast<float>());
      part.normals.push_back(normal.normalized().cast<float>());
      const auto at = first + static_cast<std::uint32_t>(i);
      if (i >= 2) part.triangles.push_back({first, at - 1, at});
    }
  }
  return part;
}

/// The geometry that contacts use for the mesh.
Mesh visible(const Mesh& mesh, Palette& palette) {
  MeshData data = *mesh.data;
  if (mesh.hulls) {
    data.parts.clear();
    for (const ConvexHull& hull : *mesh.hulls)
      data.parts.push_back(part_of(hull, static_cast<int>(data.parts.size()), palette.next()));
  } else {
    const Color color = palette.next();
    for (MeshPart& part : data.parts) {
      part.color = color;
      part.has_default_color = false;
      part.texture = nullptr;
    }
  }
  Mesh drawn = mesh;
  drawn.data = std::make_shared<const MeshData>(std::move(data));
  return drawn;
}

/// The model with its collision shapes in place of its visible ones: the hulls, convex parts and triangles of meshes
/// that contacts use, and all other shapes. Each shape and each part of a mesh has another colour than the one before.
Model with_visible_collisions(const Model& model) {
  Palette palette;
  Model shown = model;
  for (Link& link : shown.links) {
    link.visuals = link.collisions;
    for (Shape& shape : link.visuals) {
      if (auto* mesh = std::get_if<Mesh>(&shape.geometry))
        *mesh = visible(*mesh, palette);
      else
        shape.color = palette.next();
    }
  }
  return shown;
}

struct Scene {
  std::vector<PlacedModel> models;
  Look look;
};

Result<Scene> load_scene(const std::string& file, const UrdfOptions& options) {
  Scene scene;
  if (is_model(file)) {
    Model model = REHEARSE_TRY(load_model(file, options));
    const auto shared = std::make_shared<const Model>(std::move(model));
    scene.models.push_back(
        {shared, forward_kinematics(*shared, Eigen::Isometry3d::Identity(), rest_posture(*shared)), false});
    return scene;
  }
  const Scenario scenario = REHEARSE_TRY(Scenario::load(file));
  tell_warnings(scenario);
  for (const ScenarioBody& body : scenario.bodies) scene.models.push_back(place(body));
  scene.look = scenario.look;
  return scene;
}

/// Fails if there are more lights than a picture can have.
Result<void> check_lights(const Scene& scene) {
  std::size_t count = scene.look.lights.size();
  for (const PlacedModel& placed : scene.models)
    for (const Device& device : placed.model->devices) count += std::holds_alternative<Light>(device.kind) ? 1 : 0;
  if (count <= Renderer::max_lights) return {};
  return error(fmt::format("there are {} lights", count),
               fmt::format("a picture can have {} of them", Renderer::max_lights));
}

Result<void> write_file(const std::string& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) return error(fmt::format("can't write {}", file), write_hint(file, "name another file with -o"));
  return {};
}

Exit run_render(RenderSettings& settings) {
  auto scene = load_scene(settings.input, settings.urdf);
  if (!scene) return refuse(scene.errors());
  if (settings.collision)
    for (PlacedModel& placed : scene->models)
      placed.model = std::make_shared<const Model>(with_visible_collisions(*placed.model));
  if (const auto few = check_lights(*scene); !few) return refuse(few.errors());
  auto output = OutputFile::open(settings.picture, false);
  if (!output) return refuse(output.errors());
  if (const auto allowed = check_replaceable(output->path(), png_magic, "PNG picture"); !allowed)
    return refuse(allowed.errors());
  const Viewpoint view = default_viewpoint(scene->models, settings.camera, settings.eye, settings.target);
  const double distance = (view.target - view.eye).norm();
  if (distance < 1e-6) return refuse(error("--eye and --target are the same place", "give two different points"));
  settings.camera.near_clip = std::min(0.01 * distance, 0.1);
  settings.camera.far_clip = std::max(1000.0, 100.0 * distance);

  const auto renderer = Renderer::create(scene->look);
  if (!renderer) return refuse(renderer.errors());
  for (const PlacedModel& placed : scene->models) add_to(**renderer, placed);
  const Frame frame = (*renderer)->draw(settings.camera, look_at(view.eye, view.target), Quality::fine);
  if (const auto written = write_file(output->path(), encode_png(frame.color)); !written)
    return refuse(written.errors());
  fmt::print("{}: {} x {} pixels, seen from {:.3g},{:.3g},{:.3g} m towards {:.3g},{:.3g},{:.3g} m\n", settings.picture,
             settings.camera.width, settings.camera.height, view.eye.x(), view.eye.y(), view.eye.z(), view.target.x(),
             view.target.y(), view.target.z());
  return send(*output, Exit::done);
}

/// "x,y,z" [m].
Eigen::Vector3d parse_point(const std::string& option, const std::string& text) {
  const std::size_t first = text.find(',');
  const std::size_t second = first == std::string::npos ? first : text.find(',', first + 1);
  if (second == std::string::npos || text.find(',', second + 1) != std::string::npos)
    throw CLI::ValidationError(option, fmt::format("'{}' is not x,y,z", text));
  const std::string_view all = text;
  return {parse_number(option, all.substr(0, first), -farthest, farthest),
          parse_number(option, all.substr(first + 1, second - first - 1), -farthest, farthest),
          parse_number(option, all.substr(second + 1), -farthest, farthest)};
}

void add_point(CLI::App& options, const std::string& option, const std::string& help,
               std::optional<Eigen::Vector3d>& point) {
  options
      .add_option_function<std::string>(
          option, [option, &point](const std::string& text) { point = parse_point(option, text); }, help)
      ->type_name("X,Y,Z");
}

std::function<Exit()> declare_render(CLI::App& options) {
  const auto settings = std::make_shared<RenderSettings>();
  settings->camera.width = 960;
  settings->camera.height = 720;
  settings->camera.field_of_view = 35.0 * std::numbers::pi / 180.0;
  options
      .add_option("SCENARIO|MODEL", settings->input,
                  "a scenario as it starts, or a model with its joints at 0, or as near as they can be")
      ->required()
      ->type_name("");
  options.add_option("-o,--output", settings->picture, "the picture to write; - is stdout")
      ->required()
      ->type_name("PNG");
  settings->urdf.kinematic = true;  // a picture needs no masses
  add_model_options(options, settings->urdf);
  options.add_flag("--collision", settings->collision,
                   "draw the shapes that touch: hulls, convex parts and triangles of meshes, and simple shapes");
  add_integer(options, "--width", "of the picture [pixels] (960)", 1, largest_side,
              [=](std::int64_t width) { settings->camera.width = static_cast<int>(width); });
  add_integer(options, "--height", "of the picture [pixels] (720)", 1, largest_side,
              [=](std::int64_t height) { settings->camera.height = static_cast<int>(height); });
  add_point(options, "--eye", "where the camera is [m] (in front, to the right and above, so that all is seen)",
            settings->eye);
  add_point(options, "--target", "what it looks at [m] (the middle of all that isn't scenery)", settings->target);
  add_number(options, "--fov", "opening angle of the picture's shorter side [deg] (35)", 1.0, 170.0,
             [=](double degrees) { settings->camera.field_of_view = degrees * std::numbers::pi / 180.0; });
  return [settings] { return run_render(*settings); };
}

}  // namespace

extern const Verb render_verb{"render",
                              "  rehearse render fixtures/scenarios/sr1_minimum.yaml -o sr1.png\n"
                              "  rehearse render robot.urdf -o hand.png --eye 0.6,0.2,1.1 --target 0,0.3,0.9\n",
                              declare_render};

}  // namespace rehearse::tool
