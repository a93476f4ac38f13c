#include <rehearse/clock.h>
#include <rehearse/vision.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>

namespace rehearse {
namespace {

using Eigen::Isometry3d;

Isometry3d pose_of(const LinkReading& link) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = link.rotation.toRotationMatrix();
  pose.translation() = link.position;
  return pose;
}

/// First tick at or after `time`, which may be off by the rounding of its own computation.
std::int64_t tick_at_or_after(double time, double time_step) {
  return static_cast<std::int64_t>(std::ceil(time / time_step - 1e-9));
}

/// A depth camera's resolution: 13 significant bits, an error of at most 1/16384 of the distance (at 1 m: 0.06 mm). The
/// bits behind them are the rasteriser's, not the scene's, and would make up most of a recording.
void round_to_resolution(DepthImage& depth) {
  constexpr std::uint32_t dropped = 24 - 13;  // of float's 24 significant bits
  for (float& meters : depth.meters) {
    const auto bits = std::bit_cast<std::uint32_t>(meters);
    const std::uint32_t half = 1u << (dropped - 1);
    if (std::isfinite(meters)) meters = std::bit_cast<float>((bits + half) & ~((1u << dropped) - 1));
  }
}

struct Picture {
  std::int64_t captured = 0;  // tick
  std::int64_t arrives = 0;   // tick
  std::shared_ptr<const Image> color;
  std::shared_ptr<const DepthImage> depth;
};

/// One camera and its pictures on the way.
struct ActiveCamera {
  int body = 0;
  int device = 0;
  double period = 0.0;  // [s]
  bool on = true;
  std::int64_t first_tick = 0;  // of its current series of captures
  std::int64_t captures = 0;    // done in this series
  std::deque<Picture> under_way;
  Picture current;
  bool cleared = false;  // it was just switched off
};

}  // namespace

struct Vision::Impl {
  double time_step = 0.0;
  std::vector<std::shared_ptr<const Model>> models;
  std::vector<ActiveCamera> cameras;
  std::unique_ptr<Renderer> renderer;
  struct Drawn {
    int number, body, link;
  };
  std::vector<Drawn> drawn;

  void add_shapes();
  void place(const Observation& observation);
  void capture(ActiveCamera& camera, std::int64_t tick, const Observation& observation);
};

Vision::Vision() : impl_(std::make_unique<Impl>()) {}
Vision::~Vision() = default;

Result<std::unique_ptr<Vision>> Vision::create(double time_step, std::vector<std::shared_ptr<const Model>> models,
                                               std::vector<std::vector<bool>> active) {
  auto renderer = Renderer::create();
  if (!renderer) return renderer.errors();
  std::unique_ptr<Vision> vision(new Vision);
  Impl& impl = *vision->impl_;
  impl.time_step = time_step;
  impl.models = std::move(models);
  impl.renderer = std::move(*renderer);
  impl.add_shapes();
  for (std::size_t body = 0; body < impl.models.size(); ++body) {
    for (std::size_t device = 0; device < impl.models[body]->devices.size(); ++device) {
      const auto* camera = std::get_if<Camera>(&impl.models[body]->devices[device].kind);
      if (!camera || !active[body][device]) continue;
      ActiveCamera& added = impl.cameras.emplace_back();
      added.body = static_cast<int>(body);
      added.device = static_cast<int>(device);
      added.period = 1.0 / std::max(0.1, camera->frame_rate);  // Choreonoid's longest period is 10 s
    }
  }
  return vision;
}

void Vision::Impl::add_shapes() {
  static const Color default_color(0.72f, 0.72f, 0.74f, 1.0f);
  for (std::size_t body = 0; body < models.size(); ++body)
    for (std::size_t link = 0; link < models[body]->links.size(); ++link)
      for (const Shape& shape : models[body]->links[link].visuals)
        drawn.push_back({renderer->add(shape, default_color), static_cast<int>(body), static_cast<int>(link)});
}

void Vision::Impl::place(const Observation& observation) {
  for (const Drawn& shape : drawn)
    renderer->set_link_pose(shape.number, pose_of(observation.bodies[shape.body].links[shape.link]));
}

void Vision::Impl::capture(ActiveCamera& camera, std::int64_t tick, const Observation& observation) {
  const Device& device = models[camera.body]->devices[camera.device];
  const Isometry3d pose = pose_of(observation.bodies[camera.body].links[device.link]) * device.pose;
  Frame frame = renderer->draw(std::get<Camera>(device.kind), pose);
  Picture picture;
  picture.captured = tick;
  picture.arrives = tick + std::max<std::int64_t>(1, tick_at_or_after(std::min(camera.period, 1.0), time_step));
  picture.color = std::make_shared<const Image>(std::move(frame.color));
  round_to_resolution(frame.depth);
  if (!frame.depth.meters.empty()) picture.depth = std::make_shared<const DepthImage>(std::move(frame.depth));
  camera.under_way.push_back(std::move(picture));
  ++camera.captures;
}

void Vision::look(std::int64_t tick, Observation& observation) {
  bool placed = false;
  for (ActiveCamera& camera : impl_->cameras) {
    DeviceReading& reading = observation.bodies[camera.body].devices[camera.device];
    reading.fresh = camera.cleared;
    camera.cleared = false;
    if (!camera.under_way.empty() && camera.under_way.front().arrives <= tick) {
      camera.current = std::move(camera.under_way.front());
      camera.under_way.pop_front();
      reading.fresh = true;
    }
    reading.measured_at = time_of(camera.current.captured, impl_->time_step);
    reading.image = camera.current.color;
    reading.depth = camera.current.depth;
    const double due = static_cast<double>(camera.captures) * camera.period;
    if (!camera.on || tick - camera.first_tick < tick_at_or_after(due, impl_->time_step)) continue;
    if (!placed) impl_->place(observation);
    placed = true;
    impl_->capture(camera, tick, observation);
  }
}

void Vision::switch_cameras(std::int64_t tick, const Command& command) {
  for (ActiveCamera& camera : impl_->cameras) {
    const DeviceCommand& wanted = command.bodies[camera.body].devices[camera.device];
    if (!wanted.fresh || wanted.on == camera.on) continue;
    camera.on = wanted.on;
    camera.under_way.clear();
    camera.current = {};
    camera.cleared = !wanted.on;
    camera.first_tick = tick + 1;
    camera.captures = 0;
  }
}

Frame Vision::draw(const Camera& camera, const Isometry3d& pose, const Observation& observation) {
  impl_->place(observation);
  return impl_->renderer->draw(camera, pose, Quality::fine);
}

std::string Vision::renderer_description() const { return impl_->renderer->description(); }

}  // namespace rehearse
