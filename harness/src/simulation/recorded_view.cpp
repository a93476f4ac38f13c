#include "recorded_view.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "model/clock.h"
#include "viewpoint.h"

namespace rehearse {
namespace {

/// The series' value at that time; `otherwise` if the recording has no such series, or no value yet.
double value_at(const Trace& recording, const std::string& series, double time, double otherwise) {
  const auto place = recording.find_series(series);
  if (!place) return otherwise;
  const TraceChannel& channel = recording.channels()[place->channel];
  if (channel.rows() == 0 || static_cast<double>(channel.times.front()) > time * 1e9 + 1.0) return otherwise;
  return recording.at(series, time);
}

Eigen::Isometry3d root_pose(const ScenarioBody& body, const Trace& recording, double time) {
  const std::string root = body.name + "/" + body.model->links[0].name;
  constexpr std::array axes{"x", "y", "z", "w"};
  Eigen::Vector3d position = body.position;
  Eigen::Vector4d rotation = Eigen::Quaterniond(body.rotation.toRotationMatrix()).coeffs();
  for (int i = 0; i < 3; ++i) position[i] = value_at(recording, root + "/position/" + axes[i], time, position[i]);
  for (int i = 0; i < 4; ++i) rotation[i] = value_at(recording, root + "/orientation/" + axes[i], time, rotation[i]);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

PlacedModel place_at(const ScenarioBody& body, const Trace& recording, double time) {
  std::vector<double> q = body.joints;
  for (const Link& link : body.model->links) {
    const auto id = static_cast<std::size_t>(link.joint.id);
    if (link.joint.id >= 0 && id < q.size())
      q[id] = value_at(recording, body.name + "/" + link.joint.name + "/q", time, q[id]);
  }
  return {body.model, forward_kinematics(*body.model, root_pose(body, recording, time), q), body.fixed};
}

}  // namespace

Result<Image> draw_recorded(const Scenario& scenario, const Trace& recording, std::int64_t tick, int width,
                            int height) {
  const double time = time_of(tick, scenario.time_step);
  std::vector<PlacedModel> scene;
  std::size_t lights = 0;
  for (const ScenarioBody& body : scenario.bodies) {
    scene.push_back(place_at(body, recording, time));
    for (const Device& device : body.model->devices) lights += std::holds_alternative<Light>(device.kind) ? 1 : 0;
  }
  if (lights > Renderer::max_lights) return error("there are more lights than a picture can have");
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.field_of_view = 30.0 * std::numbers::pi / 180.0;
  const Viewpoint view = default_viewpoint(scene, camera, std::nullopt, std::nullopt);
  const double distance = (view.target - view.eye).norm();
  camera.near_clip = std::min(0.01 * distance, 0.1);
  camera.far_clip = std::max(1000.0, 100.0 * distance);
  const auto renderer = Renderer::create(scenario.look);
  if (!renderer) return renderer.errors();
  for (const PlacedModel& placed : scene) add_to(**renderer, placed);
  return (*renderer)->draw(camera, look_at(view.eye, view.target), Quality::fine).color;
}

}  // namespace rehearse
