#include "viewpoint.h"

#include <algorithm>
#include <cmath>

#include "model/pinhole.h"
#include "model/shape_bounds.h"

namespace rehearse {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

const Vector3d viewing_direction = Vector3d(1.0, -0.75, 0.4).normalized();  // from target to eye; robots face +x
constexpr double margin = 1.1;                                              // of the picture around the bodies
// smallest distance from the middle of the bodies [m]
constexpr double nearest = 0.1;
const Color default_color(0.72f, 0.72f, 0.74f, 1.0f);

/// The corners of the boxes around a model's visible shapes, in the world.
void add_corners(const PlacedModel& placed, std::vector<Vector3d>& corners) {
  for (std::size_t i = 0; i < placed.model->links.size(); ++i) {
    for (const Shape& shape : placed.model->links[i].visuals) {
      const AlignedBox3d box = bounds(shape.geometry, Eigen::Isometry3d::Identity());
      if (box.isEmpty()) continue;  // a mesh that could not be loaded
      const Eigen::Isometry3d pose = placed.links[i] * shape.pose;
      for (int corner = 0; corner < 8; ++corner)
        corners.push_back(pose * box.corner(static_cast<AlignedBox3d::CornerType>(corner)));
    }
  }
}

AlignedBox3d box_around(const std::vector<Vector3d>& corners) {
  AlignedBox3d box;
  for (const Vector3d& corner : corners) box.extend(corner);
  return box;
}

std::vector<Vector3d> corners_that_matter(const std::vector<PlacedModel>& scene) {
  std::vector<Vector3d> players, scenery;
  for (const PlacedModel& placed : scene)
    add_corners(placed, placed.fixed && placed.model->joints.empty() ? scenery : players);
  if (scenery.empty()) return players;
  const bool large = !players.empty() && box_around(scenery).diagonal().norm() > box_around(players).diagonal().norm();
  if (!large) players.insert(players.end(), scenery.begin(), scenery.end());
  return players;
}

/// The least distance from `target` from which all corners are inside the picture.
double distance_to_see(const std::vector<Vector3d>& corners, const Vector3d& target, const Camera& camera) {
  const Eigen::Matrix3d to_camera = look_at(target + viewing_direction, target).linear().transpose();
  const double high = std::tan(vertical_field_of_view(camera) / 2.0) / margin;
  const double wide = high * camera.width / camera.height;
  double distance = nearest;
  for (const Vector3d& corner : corners) {
    const Vector3d seen = to_camera * (corner - target);  // the camera looks along -z
    distance = std::max({distance, seen.z() + std::abs(seen.x()) / wide, seen.z() + std::abs(seen.y()) / high});
  }
  return distance;
}

}  // namespace

Viewpoint default_viewpoint(const std::vector<PlacedModel>& scene, const Camera& camera,
                            const std::optional<Vector3d>& eye, const std::optional<Vector3d>& target) {
  const std::vector<Vector3d> corners = corners_that_matter(scene);
  const Vector3d middle = corners.empty() ? Vector3d(Vector3d::Zero()) : Vector3d(box_around(corners).center());
  Viewpoint view;
  view.target = target.value_or(middle);
  view.eye = eye ? *eye : Vector3d(view.target + viewing_direction * distance_to_see(corners, view.target, camera));
  return view;
}

void add_to(Renderer& renderer, const PlacedModel& placed) {
  for (std::size_t i = 0; i < placed.model->links.size(); ++i)
    for (const Shape& shape : placed.model->links[i].visuals)
      renderer.set_link_pose(renderer.add(shape, default_color), placed.links[i]);
  for (const Device& device : placed.model->devices)
    if (const auto* light = std::get_if<Light>(&device.kind))
      renderer.set_light_pose(renderer.add_light(*light), placed.links[device.link] * device.pose);
}

}  // namespace rehearse
