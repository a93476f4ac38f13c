// The cost of depth and range relative to a colour picture of the same size in the same scene.

#include "model/pinhole.h"
#include "renderer/vision.h"
#include "world/scanner.h"

#include "pairs.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

constexpr std::int64_t period = 100;  // ticks: each look captures, and what the one before captured arrives

/// SR1 on its floor, and a body in front of it with a colour camera, a depth camera and a range sensor.
class Watcher {
 public:
  enum Device { color, depth, range };

  Watcher() {
    std::vector<WorldBody> bodies;
    for (const ScenarioBody& body : Sr1Run::instance().scenario().bodies) {
      bodies.push_back({body.name, body.model, body.fixed, body.position, body.rotation, body.joints});
      models_.push_back(body.model);
    }
    models_.push_back(make_model());
    bodies.push_back({"Watcher", models_.back(), true, {2.0, 0.5, 0.8}, Eigen::Quaterniond::Identity(), {}});
    world_ = must(World::create({}, std::move(bodies)));
    world_->step();
    seen_ = world_->sense();
    for (const Device device : {color, depth}) visions_[device] = make_vision(device);
    scanner_ = std::make_unique<Scanner>(*world_, 0.001, models_);
  }

  /// A picture of the colour camera.
  void look() { visions_[color]->look(tick_ += period, seen_); }

  /// A picture of the depth camera, and the points behind its pixels as a controller gets them.
  void look_at_depth() {
    visions_[depth]->look(tick_ += period, seen_);
    const DeviceReading& reading = seen_.bodies.back().devices[depth];
    if (reading.depth)
      points_from_depth(std::get<Camera>(models_.back()->devices[depth].kind), *reading.depth, points_);
    benchmark::DoNotOptimize(points_.data());
  }

  void scan() { scanner_->look(tick_ += period, seen_); }

 private:
  static std::shared_ptr<const Model> make_model() {
    Model model;
    model.name = "Watcher";
    model.links.resize(1);
    Camera camera;
    camera.field_of_view = 1.0;
    RangeSensor sensor;
    sensor.yaw = {-2.35619449, 2.35619449, 1081};
    sensor.max_distance = 30.0;
    const Eigen::Isometry3d towards_sr1 = rehearse::look_at(Eigen::Vector3d::Zero(), {-2.0, -0.5, -0.1});
    model.devices.push_back({"Color", 0, 0, towards_sr1, camera, 0});
    camera.depth = true;
    model.devices.push_back({"Depth", 1, 0, towards_sr1, camera, 0});
    model.devices.push_back({"Range", 2, 0, towards_sr1, sensor, 0});
    return std::make_shared<const Model>(std::move(model));
  }

  std::unique_ptr<Vision> make_vision(Device running) const {
    std::vector<std::vector<bool>> active;
    for (const auto& model : models_) active.emplace_back(model->devices.size(), false);
    active.back()[running] = true;
    return must(Vision::create(0.001, models_, std::move(active)));
  }

  std::vector<std::shared_ptr<const Model>> models_;
  std::unique_ptr<World> world_;
  Observation seen_;
  std::array<std::unique_ptr<Vision>, 2> visions_;
  std::unique_ptr<Scanner> scanner_;
  std::vector<Eigen::Vector3f> points_;
  std::int64_t tick_ = 0;
};

/// Work: Vision::look() of a depth camera of 640x480, and points_from_depth(). Base: Vision::look() of a colour camera
/// of that size at the same place.
void depth_camera_with_points_over_color_frame(benchmark::State& state) {
  Watcher watcher;
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);  // OSMesa draws in a thread of its own
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { watcher.look_at_depth(); }, [&] { watcher.look(); }));
  pairs.report(state, 1.0, 1.0);
}
BENCHMARK(depth_camera_with_points_over_color_frame)->UseManualTime()->Unit(benchmark::kMillisecond);

/// Work: Scanner::look() of a range sensor of 1081 beams. Base: as above.
void scan_over_color_frame(benchmark::State& state) {
  Watcher watcher;
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);
  for (auto _ : Repeated(state))
    state.SetIterationTime(pairs.measure([&] { watcher.scan(); }, [&] { watcher.look(); }));
  pairs.report(state, 1.0, 1.0);
}
BENCHMARK(scan_over_color_frame)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rehearse
