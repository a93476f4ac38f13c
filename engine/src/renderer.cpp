#include <rehearse/renderer.h>

#include "renderer_gl.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace rehearse {
namespace {

// From the front (+x) and the right, so that the three visible sides of a box are lit differently.
const Eigen::Vector3d sun_direction = Eigen::Vector3d(0.6, -0.35, 0.9).normalized();

template <class Vector>
std::array<float, 3> to_floats(const Vector& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// How far the unit mesh is scaled along x, y, z, and how far a capsule's caps are from its centre.
std::array<float, 4> mesh_scale(const Geometry& geometry) {
  struct Scale {
    Eigen::Vector4d operator()(const Box& box) const { return {box.size.x(), box.size.y(), box.size.z(), 0.0}; }
    Eigen::Vector4d operator()(const Sphere& s) const { return {s.radius, s.radius, s.radius, 0.0}; }
    Eigen::Vector4d operator()(const Cylinder& c) const { return {c.radius, c.radius, c.length, 0.0}; }
    Eigen::Vector4d operator()(const Capsule& c) const { return {c.radius, c.radius, c.radius, 0.5 * c.length}; }
  };
  const Eigen::Vector4f scale = std::visit(Scale{}, geometry).cast<float>();
  return {scale[0], scale[1], scale[2], scale[3]};
}

/// 1 / tan of half the horizontal and half the vertical angle. The field of view is that of the shorter side.
Eigen::Vector2d focal_lengths(const Camera& camera) {
  const double shorter = 1.0 / std::tan(0.5 * camera.field_of_view);
  const double aspect = static_cast<double>(camera.width) / camera.height;
  return camera.width >= camera.height ? Eigen::Vector2d(shorter / aspect, shorter)
                                       : Eigen::Vector2d(shorter, shorter * aspect);
}

void check(const Camera& camera) {
  REHEARSE_ASSERT(camera.width >= 1 && camera.width <= Renderer::max_size, "a camera's width is 1 to 8192 pixels");
  REHEARSE_ASSERT(camera.height >= 1 && camera.height <= Renderer::max_size, "a camera's height is 1 to 8192 pixels");
  REHEARSE_ASSERT(camera.field_of_view > 0.0 && camera.field_of_view < std::numbers::pi,
                  "a camera's field of view is between 0 and pi");
  REHEARSE_ASSERT(camera.near_clip > 0.0 && camera.far_clip > camera.near_clip,
                  "a camera's far clip is beyond its near clip, and both are in front of it");
}

}  // namespace

struct Renderer::Impl {
  struct Item {
    std::size_t mesh;  // as Geometry's alternatives are numbered
    std::array<float, 4> scale;
    std::array<float, 4> color;
    Eigen::Isometry3d shape_pose;  // in the link's frame
    Eigen::Isometry3d world_pose;
  };

  std::unique_ptr<gl::Context> context;
  std::unique_ptr<gl::Painter> painter;
  gl::Target target;
  Look look;
  std::vector<Item> items;

  void draw(const Camera& camera, const Eigen::Isometry3d& pose);
  void paint_solid(const Eigen::Isometry3d& view);
  void paint_translucent(const Eigen::Isometry3d& view);
};

namespace {

gl::Instance instance_of(const auto& item, const Eigen::Isometry3d& view) {
  const Eigen::Isometry3d pose = view * item.world_pose;
  gl::Instance instance{{}, to_floats(pose.translation()), item.scale, item.color};
  Eigen::Map<Eigen::Matrix3f>(instance.rotation.data()) = pose.linear().cast<float>();
  return instance;
}

}  // namespace

/// One call of OpenGL per kind of shape; their order doesn't show.
void Renderer::Impl::paint_solid(const Eigen::Isometry3d& view) {
  std::array<std::vector<gl::Instance>, std::variant_size_v<Geometry>> by_mesh;
  for (const Item& item : items) {
    if (item.color[3] >= 1.0f) by_mesh[item.mesh].push_back(instance_of(item, view));
  }
  for (std::size_t mesh = 0; mesh < by_mesh.size(); ++mesh) {
    if (!by_mesh[mesh].empty()) painter->paint(mesh, by_mesh[mesh], false);
  }
}

/// The farthest first, by the distance of their centres; equally far ones in the order in which they were added.
void Renderer::Impl::paint_translucent(const Eigen::Isometry3d& view) {
  std::vector<std::pair<std::size_t, gl::Instance>> translucent;
  for (const Item& item : items) {
    if (item.color[3] > 0.0f && item.color[3] < 1.0f) translucent.emplace_back(item.mesh, instance_of(item, view));
  }
  std::stable_sort(translucent.begin(), translucent.end(),
                   [](const auto& a, const auto& b) { return a.second.origin[2] < b.second.origin[2]; });
  for (const auto& [mesh, instance] : translucent) painter->paint(mesh, {&instance, 1}, true);
}

void Renderer::Impl::draw(const Camera& camera, const Eigen::Isometry3d& pose) {
  check(camera);
  context->make_current();
  target.begin(camera.width, camera.height, camera.depth, look.sky);
  const Eigen::Isometry3d view = pose.inverse();
  const Eigen::Vector2f focal = focal_lengths(camera).cast<float>();
  painter->begin({{focal.x(), focal.y(), static_cast<float>(camera.near_clip), static_cast<float>(camera.far_clip)},
                  to_floats(view.linear() * Eigen::Vector3d::UnitZ()),
                  to_floats(view.linear() * sun_direction)});
  paint_solid(view);
  paint_translucent(view);
}

Renderer::Renderer() : impl_(std::make_unique<Impl>()) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create(const Look& look) {
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  if (!context) return context.errors();
  std::unique_ptr<Renderer> renderer(new Renderer);
  renderer->impl_->context = std::move(*context);
  renderer->impl_->painter = std::make_unique<gl::Painter>();
  renderer->impl_->look = look;
  return renderer;
}

int Renderer::add(const Shape& shape, const Color& color) {
  const Color used = shape.color.value_or(color);
  impl_->items.push_back({shape.geometry.index(),
                          mesh_scale(shape.geometry),
                          {used[0], used[1], used[2], used[3]},
                          shape.pose,
                          shape.pose});
  return static_cast<int>(impl_->items.size()) - 1;
}

void Renderer::set_link_pose(int number, const Eigen::Isometry3d& link_pose) {
  REHEARSE_ASSERT(number >= 0 && static_cast<std::size_t>(number) < impl_->items.size(), "no such shape was added");
  Impl::Item& item = impl_->items[static_cast<std::size_t>(number)];
  item.world_pose = link_pose * item.shape_pose;
}

Frame Renderer::draw(const Camera& camera, const Eigen::Isometry3d& pose) {
  impl_->draw(camera, pose);
  return {impl_->target.read_color(), impl_->target.read_depth()};
}

void Renderer::draw_only(const Camera& camera, const Eigen::Isometry3d& pose) {
  impl_->draw(camera, pose);
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
