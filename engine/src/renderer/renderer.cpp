#include <rehearse/renderer.h>

#include "renderer_gl.h"
#include "renderer_items.h"
#include "renderer_painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rehearse {
namespace {

// The sun shines from the front (+x) and the left, so that the sides of a box are lit differently.
const Eigen::Vector3d sun_direction = Eigen::Vector3d(0.55, 0.45, 1.0).normalized();

constexpr double shadow_blur = 0.006;  // distance between two samples of a shadow's edge [m]

/// The factor by which a picture with antialiasing is drawn larger, each way, before it is reduced.
constexpr int shrink_factor(Quality quality) { return quality.antialiasing ? 3 : 1; }

template <class Vector>
std::array<float, 3> to_floats(const Vector& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// 1 / tan of half the horizontal and half the vertical angle. The field of view belongs to the shorter side.
Eigen::Vector2d focal_lengths(const Camera& camera) {
  const double shorter = 1.0 / std::tan(0.5 * camera.field_of_view);
  const double aspect = static_cast<double>(camera.width) / camera.height;
  return camera.width >= camera.height ? Eigen::Vector2d(shorter / aspect, shorter)
                                       : Eigen::Vector2d(shorter, shorter * aspect);
}

/// The projection from the camera's frame to the picture, upside down: see gl::Painter.
Eigen::Matrix4d projection_of(const Camera& camera) {
  const Eigen::Vector2d focal = focal_lengths(camera);
  const double depth = camera.far_clip - camera.near_clip;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = focal.x();
  projection(1, 1) = -focal.y();
  projection(2, 2) = camera.near_clip / depth;
  projection(2, 3) = camera.near_clip * camera.far_clip / depth;
  projection(3, 2) = -1.0;
  return projection;
}

gl::Matrix4 to_floats(const Eigen::Matrix4d& matrix) {
  gl::Matrix4 floats;
  Eigen::Map<Eigen::Matrix4f>(floats.data()) = matrix.cast<float>();
  return floats;
}

void check(const Camera& camera, int largest) {
  REHEARSE_ASSERT(camera.width >= 1 && camera.width <= largest,
                  "a picture's width is 1 to 8192 pixels, 2730 with antialiasing");
  REHEARSE_ASSERT(camera.height >= 1 && camera.height <= largest,
                  "a picture's height is 1 to 8192 pixels, 2730 with antialiasing");
  REHEARSE_ASSERT(camera.field_of_view > 0.0 && camera.field_of_view < std::numbers::pi,
                  "a camera's field of view is between 0 and pi");
  REHEARSE_ASSERT(camera.near_clip > 0.0 && camera.far_clip > camera.near_clip,
                  "a camera's far clip is beyond its near clip, and both are in front of it");
}

gl::Instance instance_of(const Item& item, const Eigen::Isometry3d& view) {
  const Eigen::Isometry3d pose = view * item.world_pose;
  gl::Instance instance{{}, to_floats(pose.translation()), item.scale, item.color};
  Eigen::Map<Eigen::Matrix3f>(instance.rotation.data()) = pose.linear().cast<float>();
  return instance;
}

struct PlacedLight {
  Light light;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the light's device frame
};

/// The number, limited to the range; the lower bound if it isn't a number.
float within(double value, double lower, double upper) {
  return static_cast<float>(value > lower ? std::min(value, upper) : lower);
}

gl::Lamp lamp_of(const PlacedLight& placed, const Eigen::Isometry3d& view) {
  constexpr double brightest = 1e6, shortest = 1e-6;  // shortest range [m]
  constexpr double steepest_edge = 1e4;               // of a cone: its edge is at least 1e-4 wide in the cosine
  const Light& light = placed.light;
  const Eigen::Isometry3d pose = view * placed.pose;
  const std::array<float, 3> place = to_floats(pose.translation());
  gl::Lamp lamp{};
  lamp.place = {place[0], place[1], place[2], within(1.0 / light.range, 0.0, 1.0 / shortest)};
  for (int i = 0; i < 3; ++i) lamp.strength[i] = within(double{light.color[i]} * light.intensity, 0.0, brightest);
  lamp.fading = {within(light.constant, 0.0, brightest), within(light.linear, 0.0, brightest),
                 within(light.quadratic, 0.0, brightest), 1.0f};
  lamp.strength[3] = -2.0f;  // no angle from the axis has this cosine: the light shines in all directions
  if (!light.cone) return lamp;
  const double length = light.cone->direction.norm();
  const bool has_direction = length > 0.0 && std::isfinite(length);
  const Eigen::Vector3d direction =
      has_direction ? Eigen::Vector3d(light.cone->direction / length) : Eigen::Vector3d(-Eigen::Vector3d::UnitZ());
  const std::array<float, 3> axis = to_floats(Eigen::Vector3d(pose.linear() * direction));
  const double end = within(light.cone->cut_off_angle, 0.0, std::numbers::pi);
  const double full = within(light.cone->beam_width, 0.0, end);
  lamp.axis = {axis[0], axis[1], axis[2], 0.0f};
  lamp.strength[3] = static_cast<float>(std::cos(end));
  lamp.fading[3] = within(1.0 / (std::cos(full) - std::cos(end)), 0.0, steepest_edge);
  return lamp;
}

/// The camera's viewing pyramid.
struct Sight {
  Eigen::Isometry3d from_world;
  Eigen::Vector2d focal;

  /// False only if no part of the item is in front of the camera and between the four sides of its picture.
  bool may_hold(const Item& item) const {
    const Eigen::Vector3d centre = from_world * item.world_centre;
    const double distance = -centre.z();
    if (distance < -item.radius) return false;
    for (int axis = 0; axis < 2; ++axis) {
      const double beyond_the_side = std::abs(centre[axis]) * focal[axis] - distance;
      if (beyond_the_side > item.radius * std::hypot(1.0, focal[axis])) return false;
    }
    return true;
  }
};

}  // namespace

struct Renderer::Impl {
  explicit Impl(std::unique_ptr<gl::Context> current) : context(std::move(current)) {}

  std::unique_ptr<gl::Context> context;  // first, because the members below belong to it
  gl::Painter painter;
  ItemMaker maker{painter};
  gl::Target target;
  gl::ShadowMap shadow_map;
  Look look;
  std::vector<Item> items;
  std::vector<std::size_t> ends;  // end of each shape's items
  std::vector<PlacedLight> lights;

  Eigen::Matrix4d draw_shadow_map(double& radius);
  void draw(const Camera& camera, const Eigen::Isometry3d& pose, Quality quality);
  template <class Wanted>
  void paint_solid(const Eigen::Isometry3d& view, Wanted wanted);
  void paint_translucent(const Sight& sight);
};

/// Draws opaque items with one OpenGL call per batch; the order of batches doesn't change the picture.
template <class Wanted>
void Renderer::Impl::paint_solid(const Eigen::Isometry3d& view, Wanted wanted) {
  const std::vector<Batch>& batches = maker.batches();
  std::vector<std::vector<gl::Instance>> by_batch(batches.size());
  for (const Item& item : items) {
    if (item.solid() && wanted(item)) by_batch[item.batch].push_back(instance_of(item, view));
  }
  for (std::size_t i = 0; i < batches.size(); ++i) {
    if (!by_batch[i].empty()) painter.paint(batches[i].mesh, batches[i].skin, by_batch[i], false);
  }
}

/// Draws translucent items, the farthest first, by the distance of their centres; equally far ones in the order in
/// which they were added.
void Renderer::Impl::paint_translucent(const Sight& sight) {
  std::vector<std::pair<float, const Item*>> sorted;
  for (const Item& item : items) {
    if (!item.translucent() || !sight.may_hold(item)) continue;
    sorted.emplace_back(static_cast<float>((sight.from_world * item.world_centre).z()), &item);
  }
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [z, item] : sorted) {
    const gl::Instance instance = instance_of(*item, sight.from_world);
    const Batch& batch = maker.batches()[item->batch];
    painter.paint(batch.mesh, batch.skin, {&instance, 1}, true);
  }
}

/// Draws all items that cast shadows into the shadow map, over a square of 2 `radius` [m] each way.
/// Returns the transform from the world to the map's coordinates (0 to 1; z from 1 down to 0 away from the sun).
Eigen::Matrix4d Renderer::Impl::draw_shadow_map(double& radius) {
  Eigen::AlignedBox3d bounds;
  for (const Item& item : items) {
    if (!item.casts_shadow()) continue;
    bounds.extend((item.world_centre.array() - item.radius).matrix());
    bounds.extend((item.world_centre.array() + item.radius).matrix());
  }
  if (bounds.isEmpty()) bounds.extend(Eigen::Vector3d::Zero());
  const Eigen::Vector3d centre = bounds.center();
  radius = std::max(0.1, 0.5 * bounds.diagonal().norm());
  const Eigen::Isometry3d sun_from_world = look_at(centre + radius * sun_direction, centre).inverse();
  const Eigen::DiagonalMatrix<double, 4> parallel(1.0 / radius, -1.0 / radius, 0.5 / radius, 1.0);
  Eigen::Matrix4d projection = parallel;
  projection(2, 3) = 1.0;
  shadow_map.begin();
  painter.begin(gl::Pass::shadow, {to_floats(projection)});
  paint_solid(sun_from_world, [](const Item& item) { return item.casts_shadow(); });
  Eigen::Matrix4d map_from_clip = Eigen::Matrix4d::Identity();
  map_from_clip(0, 0) = map_from_clip(1, 1) = map_from_clip(0, 3) = map_from_clip(1, 3) = 0.5;
  return map_from_clip * projection * sun_from_world.matrix();
}

void Renderer::Impl::draw(const Camera& camera, const Eigen::Isometry3d& pose, Quality quality) {
  const int factor = shrink_factor(quality);
  check(camera, max_size / factor);
  context->make_current();
  const Sight sight{pose.inverse(), focal_lengths(camera)};
  gl::View view{to_floats(projection_of(camera))};
  view.up = to_floats(sight.from_world.linear() * Eigen::Vector3d::UnitZ());
  view.sun = to_floats(sight.from_world.linear() * sun_direction);
  if (quality.shadows) {
    double radius = 0.0;
    view.shadow_from_view = to_floats(Eigen::Matrix4d(draw_shadow_map(radius) * pose.matrix()));
    view.blur = static_cast<float>(shadow_blur / (2.0 * radius));
    // at least the distance of the farthest shadow sample plus the size of a texel: so a surface doesn't shade itself
    view.lift = static_cast<float>(2.0 * std::numbers::sqrt2 * shadow_blur + 4.0 * radius / gl::ShadowMap::size);
  }
  for (const PlacedLight& light : lights)
    if (light.light.on) view.lamps.push_back(lamp_of(light, sight.from_world));
  target.begin(factor * camera.width, factor * camera.height, camera.depth, look.sky);
  painter.begin(quality.shadows ? gl::Pass::shaded : gl::Pass::plain, view);
  paint_solid(sight.from_world, [&](const Item& item) { return sight.may_hold(item); });
  paint_translucent(sight);
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create(const Look& look) {
  std::unique_ptr<gl::Context> context = REHEARSE_TRY(gl::Context::create());
  auto impl = std::make_unique<Impl>(std::move(context));
  impl->look = look;
  if (look.lights.size() > max_lights)
    return error("there are " + std::to_string(look.lights.size()) + " lights",
                 "a picture can have " + std::to_string(max_lights) + " of them");
  std::unique_ptr<Renderer> renderer(new Renderer(std::move(impl)));
  for (const SceneLight& lamp : look.lights)
    renderer->set_light_pose(renderer->add_light(lamp.light), Eigen::Isometry3d(Eigen::Translation3d(lamp.position)));
  return renderer;
}

int Renderer::add(const Shape& shape, const Color& color) {
  impl_->context->make_current();
  const std::vector<Item> items = impl_->maker.items_of(shape, color);
  impl_->items.insert(impl_->items.end(), items.begin(), items.end());
  impl_->ends.push_back(impl_->items.size());
  return static_cast<int>(impl_->ends.size()) - 1;
}

void Renderer::set_link_pose(int number, const Eigen::Isometry3d& link_pose) {
  REHEARSE_ASSERT(number >= 0 && static_cast<std::size_t>(number) < impl_->ends.size(),
                  "a shape with this number was added");
  const auto shape = static_cast<std::size_t>(number);
  for (std::size_t i = shape == 0 ? 0 : impl_->ends[shape - 1]; i < impl_->ends[shape]; ++i)
    impl_->items[i].place(link_pose);
}

int Renderer::add_light(const Light& light) {
  REHEARSE_ASSERT(impl_->lights.size() < max_lights, "there are no more lights than a picture may have");
  impl_->lights.push_back({light});
  return static_cast<int>(impl_->lights.size()) - 1;
}

void Renderer::set_light(int number, const Light& light) {
  impl_->lights.at(static_cast<std::size_t>(number)).light = light;
}

void Renderer::set_light_pose(int number, const Eigen::Isometry3d& pose) {
  impl_->lights.at(static_cast<std::size_t>(number)).pose = pose;
}

Frame Renderer::draw(const Camera& camera, const Eigen::Isometry3d& pose, Quality quality) {
  impl_->draw(camera, pose, quality);
  const int factor = shrink_factor(quality);
  return {impl_->target.read_color(factor), impl_->target.read_depth(factor)};
}

void Renderer::draw_only(const Camera& camera, const Eigen::Isometry3d& pose) {
  impl_->draw(camera, pose, Quality::plain);
  gl::finish();
}

std::string Renderer::description() const { return impl_->context->description(); }

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  REHEARSE_ASSERT(eye != target, "a camera can't look at where it is");
  const Eigen::Vector3d z = (eye - target).normalized();
  const bool vertical = std::hypot(z.x(), z.y()) < 1e-9;
  const Eigen::Vector3d up = vertical ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  Eigen::Isometry3d pose;
  const Eigen::Vector3d x = up.cross(z).normalized();
  pose.matrix() << x.x(), z.cross(x).x(), z.x(), eye.x(),  //
      x.y(), z.cross(x).y(), z.y(), eye.y(),               //
      x.z(), z.cross(x).z(), z.z(), eye.z(),               //
      0.0, 0.0, 0.0, 1.0;
  return pose;
}

}  // namespace rehearse
