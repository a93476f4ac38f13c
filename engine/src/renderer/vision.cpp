#include "vision.h"

#include <algorithm>
#include <optional>
#include <string>

#include "exposure.h"
#include "model/capture_cycle.h"

namespace rehearse {
namespace {

using Eigen::Isometry3d;

struct Picture {
  std::shared_ptr<const Image> color;
  std::shared_ptr<const DepthImage> depth;
};

struct ShownLight {
  int body = 0;
  int device = 0;
  int number = 0;  // in the renderer
};

/// A picture whose shutter is open.
struct OpenPicture {
  std::int64_t captured, last;   // ticks
  std::shared_ptr<Image> color;  // that of the picture under way, empty until the shutter closes
  LightSum light;
  std::size_t next = 0;  // index into the camera's ticks
};

struct ActiveCamera {
  int body = 0;
  int device = 0;
  CaptureCycle<Picture> cycle;
  std::vector<ExposedTick> ticks;  // of a capture; empty: it is a moment
  std::optional<OpenPicture> open = {};
};

}  // namespace

struct Vision::Impl {
  std::vector<std::shared_ptr<const Model>> models;
  std::vector<ActiveCamera> cameras;
  std::unique_ptr<Renderer> renderer;
  Look look;
  struct Drawn {
    int number, body, link;
  };
  std::vector<Drawn> drawn;
  std::vector<ShownLight> lights;

  void add_shapes();
  Result<void> add_lights();
  void place(const Observation& observation);
  const Camera& settings_of(const ActiveCamera& camera) const {
    return std::get<Camera>(models[camera.body]->devices[camera.device].kind);
  }
  Frame draw(const ActiveCamera& camera, const Observation& observation, bool with_depth);
  Picture capture(const ActiveCamera& camera, const Observation& observation);
  void open(ActiveCamera& camera, std::int64_t tick, const Observation& observation);
  void expose(ActiveCamera& camera, std::int64_t tick, const Observation& observation);
  Quality quality_of(const Camera& camera) const {
    return {camera.shadows || look.shadows, camera.antialiasing || look.antialiasing};
  }
  Result<void> check_size(const Camera& camera, const std::string& name) const;
};

Vision::Vision() : impl_(std::make_unique<Impl>()) {}
Vision::~Vision() = default;

Result<std::unique_ptr<Vision>> Vision::create(double time_step, std::vector<std::shared_ptr<const Model>> models,
                                               std::vector<std::vector<bool>> active, const Look& look) {
  auto renderer = REHEARSE_TRY(Renderer::create(look));
  std::unique_ptr<Vision> vision(new Vision);
  Impl& impl = *vision->impl_;
  impl.models = std::move(models);
  impl.renderer = std::move(renderer);
  impl.look = look;
  impl.add_shapes();
  REHEARSE_TRY(impl.add_lights());
  for (std::size_t body = 0; body < impl.models.size(); ++body) {
    for (std::size_t device = 0; device < impl.models[body]->devices.size(); ++device) {
      const auto* camera = std::get_if<Camera>(&impl.models[body]->devices[device].kind);
      if (!camera || !active[body][device]) continue;
      REHEARSE_TRY(impl.check_size(*camera, impl.models[body]->devices[device].name));
      impl.cameras.push_back({static_cast<int>(body),
                              static_cast<int>(device),
                              {camera->frame_rate, time_step},
                              exposed_ticks(camera->exposure, camera->height, time_step)});
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

Result<void> Vision::Impl::add_lights() {
  for (std::size_t body = 0; body < models.size(); ++body) {
    for (std::size_t device = 0; device < models[body]->devices.size(); ++device) {
      const auto* light = std::get_if<Light>(&models[body]->devices[device].kind);
      if (!light) continue;
      if (lights.size() + look.lights.size() == Renderer::max_lights)
        return error("there are more than " + std::to_string(Renderer::max_lights) + " lights",
                     "no picture can have more of them");
      lights.push_back({static_cast<int>(body), static_cast<int>(device), renderer->add_light(*light)});
    }
  }
  return {};
}

Result<void> Vision::Impl::check_size(const Camera& camera, const std::string& name) const {
  constexpr int largest = Renderer::max_size / 3;
  if (!quality_of(camera).antialiasing || (camera.width <= largest && camera.height <= largest)) return {};
  return error("camera '" + name + "' has " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                   " pixels and antialiasing",
               "with antialiasing a picture has at most " + std::to_string(largest) + " each way");
}

void Vision::Impl::place(const Observation& observation) {
  for (const Drawn& shape : drawn)
    renderer->set_link_pose(shape.number, pose_of(observation.bodies[shape.body].links[shape.link]));
  for (const ShownLight& light : lights) {
    const Device& device = models[light.body]->devices[light.device];
    renderer->set_light_pose(light.number, pose_of(observation.bodies[light.body].links[device.link]) * device.pose);
  }
}

Frame Vision::Impl::draw(const ActiveCamera& camera, const Observation& observation, bool with_depth) {
  const Device& device = models[camera.body]->devices[camera.device];
  const Isometry3d pose = pose_of(observation.bodies[camera.body].links[device.link]) * device.pose;
  Camera settings = settings_of(camera);
  settings.depth = settings.depth && with_depth;
  return renderer->draw(settings, pose, quality_of(settings));
}

Picture Vision::Impl::capture(const ActiveCamera& camera, const Observation& observation) {
  Frame frame = draw(camera, observation, true);
  Picture picture;
  picture.color = std::make_shared<const Image>(std::move(frame.color));
  round_to_resolution(frame.depth);
  if (!frame.depth.meters.empty()) picture.depth = std::make_shared<const DepthImage>(std::move(frame.depth));
  return picture;
}

/// The picture is on its way from now on, and gets its colours when the shutter closes. Depth is that of this tick.
void Vision::Impl::open(ActiveCamera& camera, std::int64_t tick, const Observation& observation) {
  const Camera& settings = settings_of(camera);
  auto color = std::make_shared<Image>();
  Picture picture;
  if (settings.depth) picture.depth = capture(camera, observation).depth;
  picture.color = color;
  const std::int64_t arrives = camera.cycle.capture(tick, std::move(picture));
  camera.open = {tick, arrives - 1, std::move(color), LightSum(settings.width, settings.height)};
}

/// Adds the light of this tick to the open picture.
void Vision::Impl::expose(ActiveCamera& camera, std::int64_t tick, const Observation& observation) {
  OpenPicture& picture = *camera.open;
  const auto is_due = [&] {
    return picture.next < camera.ticks.size() &&
           std::min(picture.captured + camera.ticks[picture.next].after, picture.last) <= tick;
  };
  if (!is_due()) return;
  const Image now = draw(camera, observation, false).color;
  for (; is_due(); ++picture.next) picture.light.add(now, camera.ticks[picture.next].weights);
  if (picture.next < camera.ticks.size()) return;
  *picture.color = picture.light.mean();
  camera.open.reset();
}

void Vision::look(std::int64_t tick, Observation& observation) {
  bool placed = false;
  const auto place = [&] {
    if (!std::exchange(placed, true)) impl_->place(observation);
  };
  for (ActiveCamera& camera : impl_->cameras) {
    DeviceReading& reading = observation.bodies[camera.body].devices[camera.device];
    reading.fresh = camera.cycle.deliver(tick);
    reading.measured_at = camera.cycle.captured_at();
    reading.image = camera.cycle.current().color;
    reading.depth = camera.cycle.current().depth;
    const bool is_due = camera.cycle.is_due(tick);
    if (!is_due && !camera.open) continue;
    place();
    if (is_due && camera.ticks.empty())
      camera.cycle.capture(tick, impl_->capture(camera, observation));
    else if (is_due)
      impl_->open(camera, tick, observation);
    if (camera.open) impl_->expose(camera, tick, observation);
  }
}

void Vision::begin_at(std::int64_t tick) {
  for (ActiveCamera& camera : impl_->cameras) {
    camera.cycle.begin_at(tick);
    camera.open.reset();
  }
}

void Vision::obey(std::int64_t tick, const Command& command) {
  for (const ShownLight& light : impl_->lights) {
    const DeviceCommand& wanted = command.bodies[light.body].devices[light.device];
    if (!wanted.fresh) continue;
    const auto& designed = std::get<Light>(impl_->models[light.body]->devices[light.device].kind);
    impl_->renderer->set_light(light.number, light_of_state(designed, wanted.values));
  }
  for (ActiveCamera& camera : impl_->cameras) {
    const DeviceCommand& wanted = command.bodies[camera.body].devices[camera.device];
    if (!wanted.fresh) continue;
    camera.cycle.switch_to(wanted.on, tick);
    if (!wanted.on) camera.open.reset();
  }
}

Frame Vision::draw(const Camera& camera, const Isometry3d& pose, const Observation& observation) {
  impl_->place(observation);
  return impl_->renderer->draw(camera, pose, Quality::fine);
}

std::string Vision::renderer_description() const { return impl_->renderer->description(); }

}  // namespace rehearse
