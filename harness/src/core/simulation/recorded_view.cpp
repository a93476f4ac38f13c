#include "recorded_view.h"

#include <pthread.h>
#include <rehearse/diagnostic.h>
#include <rehearse/renderer.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "base/clock.h"
#include "picture/picture.h"
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

/// The recorded pose of a link; `otherwise` if the recording has none.
Eigen::Isometry3d recorded_pose(const ScenarioBody& body, const Link& link, const Trace& recording, double time,
                                const Eigen::Isometry3d& otherwise) {
  const std::string series = body.name + "/" + link.name;
  constexpr std::array axes{"x", "y", "z", "w"};
  Eigen::Vector3d position = otherwise.translation();
  Eigen::Vector4d rotation = Eigen::Quaterniond(otherwise.linear()).coeffs();
  for (int i = 0; i < 3; ++i) position[i] = value_at(recording, series + "/position/" + axes[i], time, position[i]);
  for (int i = 0; i < 4; ++i) rotation[i] = value_at(recording, series + "/orientation/" + axes[i], time, rotation[i]);
  return pose_of(position, Eigen::Quaterniond(rotation).normalized());
}

PlacedModel place_at(const ScenarioBody& body, const Trace& recording, double time) {
  std::vector<double> q = body.joints;
  for (const Link& link : body.model->links) {
    const auto id = static_cast<std::size_t>(link.joint.id);
    if (link.joint.id >= 0 && id < q.size())
      q[id] = value_at(recording, body.name + "/" + link.joint.name + "/q", time, q[id]);
  }
  const Eigen::Isometry3d root = pose_of(body.position, body.rotation);
  const auto free_pose = [&](std::size_t link, const Eigen::Isometry3d& otherwise) {
    return recorded_pose(body, body.model->links[link], recording, time, otherwise);
  };
  return {body.model, forward_kinematics(*body.model, free_pose(0, root), q, free_pose), body.fixed};
}

/// `width`, `height`: [pixels]. Fails if nothing can be drawn.
Result<Image> draw_recorded(const Scenario& scenario, const Trace& recording, std::int64_t tick, int width,
                            int height) {
  const double time = time_of(tick, scenario.time_step);
  std::vector<PlacedModel> scene;
  std::size_t lights = scenario.look.lights.size();
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
  const auto renderer = REHEARSE_TRY(Renderer::create(scenario.look));
  for (const PlacedModel& placed : scene) add_to(*renderer, placed);
  return renderer->draw(camera, look_at(view.eye, view.target), Quality::fine).color;
}

}  // namespace

std::vector<std::uint8_t> thumbnail_of(const Scenario& scenario, const Trace& recording, std::int64_t tick) {
  static bool is_forked = false;
  static const int watches = pthread_atfork(nullptr, nullptr, [] { is_forked = true; });
  if (watches != 0 || is_forked) return {};
  const auto picture = draw_recorded(scenario, recording, tick, 320, 240);
  return picture ? encode_png(*picture) : std::vector<std::uint8_t>();
}

}  // namespace rehearse
