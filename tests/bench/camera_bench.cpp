// The cost of a recorded camera frame relative to drawing it.
#include "../engine/renderer/mesh_shapes.h"

#include "renderer/vision.h"

#include "core/host/controller_host.h"
#include "core/recording/recorder.h"
#include "pairs.h"
#include "pinned_child.h"
#include "sr1_run.h"

namespace rehearse {
namespace {

/// The floor, and on it, before SR1's eyes, textured meshes of 60000 triangles.
std::shared_ptr<const Model> with_meshes(const Model& floor) {
  std::vector<std::array<std::uint8_t, 4>> texels;
  for (int i = 0; i < 256 * 256; ++i) {
    const auto shade = static_cast<std::uint8_t>(i % 32 < 2 || i / 256 % 32 < 2 ? 60 : 180 + i * 7919 % 23);
    texels.push_back({shade, shade, static_cast<std::uint8_t>(shade / 2), 255});
  }
  const Mesh mesh = mesh_of({with_texture(ball(0.3, 70), texture_of(256, 256, texels)),
                             with_color(moved(cuboid({0.5, 0.2, 0.3}), {0, 0, 0.4f}), {0.9f, 0.5f, 0.1f, 1.0f})});
  Model model = floor;
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(1.5, -0.5, 1), Eigen::Vector3d(2, 0.6, 1.2), Eigen::Vector3d(3, 0, 1)}) {
    Shape shape;
    shape.geometry = mesh;
    shape.pose.translation() = place;
    model.links[0].visuals.push_back(shape);
  }
  return std::make_shared<const Model>(std::move(model));
}

/// SR1's two cameras, drawn and recorded as in a session, or only drawn.
class Cameras {
 public:
  explicit Cameras(bool meshes) : world_(Sr1Run::instance().make_world()), renderer_(must(Renderer::create())) {
    recorded_ = Sr1Run::instance().scenario();
    if (meshes) recorded_.bodies[0].model = with_meshes(*recorded_.bodies[0].model);
    const Scenario& scenario = recorded_;
    recorded_.cameras.reset();  // all
    world_->step();
    seen_ = world_->sense();
    host_ = must(ControllerHost::create(recorded_, {}));
    std::vector<std::shared_ptr<const Model>> models;
    std::vector<std::vector<bool>> active;
    for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
      models.push_back(scenario.bodies[b].model);
      active.emplace_back(models[b]->devices.size(), true);
      add_shapes(*models[b], seen_.bodies[b]);
      add_cameras(*models[b], seen_.bodies[b]);
    }
    vision_ = must(Vision::create(scenario.time_step, std::move(models), std::move(active)));
    vision_->look(0, seen_);
    begin_file();
  }

  std::size_t count() const { return cameras_.size(); }

  void draw_only() {
    for (const auto& [camera, pose] : cameras_) renderer_->draw_only(camera, pose);
  }

  /// One picture of each camera: drawn, read back, encoded, written.
  void record() {
    constexpr std::int64_t period = 34;  // ticks: each call captures, and the captures of the one before arrive
    tick_ += period;
    vision_->look(tick_, seen_);
    must_succeed(recorder_->record_state(tick_, seen_, seen_));
  }

  /// A new file now and then, so that measuring for long fills no disk.
  void begin_file() {
    if (recorder_ && ++since_file_ < 200) return;
    since_file_ = 0;
    if (recorder_) must_succeed(recorder_->close({}));
    recorder_ = must(Recorder::create(Sr1Run::instance().folder() / "frames.mcap", recorded_, {}));
    recorder_->declare(host_.get());
  }

 private:
  static void must_succeed(const Result<void>& result) {
    if (!result) must(Result<int>(result.errors()));
  }

  void add_shapes(const Model& model, const BodyObservation& seen) {
    for (std::size_t i = 0; i < model.links.size(); ++i)
      for (const Shape& shape : model.links[i].visuals)
        renderer_->set_link_pose(renderer_->add(shape, Color(0.72f, 0.72f, 0.74f, 1.0f)), pose_of(seen.links[i]));
  }

  void add_cameras(const Model& model, const BodyObservation& seen) {
    for (const Device& device : model.devices)
      if (const auto* camera = std::get_if<Camera>(&device.kind))
        cameras_.emplace_back(*camera, pose_of(seen.links[device.link]) * device.pose);
  }

  std::unique_ptr<World> world_;
  std::unique_ptr<Renderer> renderer_;
  Scenario recorded_;
  Observation seen_;
  std::unique_ptr<ControllerHost> host_;
  std::unique_ptr<Vision> vision_;
  std::unique_ptr<Recorder> recorder_;
  std::vector<std::pair<Camera, Eigen::Isometry3d>> cameras_;
  std::int64_t tick_ = 0;
  int since_file_ = 0;
};

/// Work: Vision::look() and Recorder::record_state(). Base: Renderer::draw_only() of the same cameras in the same
/// scene.
void measure_recorded_frames(benchmark::State& state, bool meshes) {
  Cameras cameras(meshes);
  Pairs pairs(CLOCK_PROCESS_CPUTIME_ID);  // OSMesa draws in a thread of its own
  for (auto _ : Repeated(state)) {
    cameras.begin_file();
    state.SetIterationTime(pairs.measure([&] { cameras.record(); }, [&] { cameras.draw_only(); }));
  }
  pairs.report(state, static_cast<double>(cameras.count()), static_cast<double>(cameras.count()));
}
void recorded_frame_over_bare_draw(benchmark::State& state) { measure_recorded_frames(state, false); }
BENCHMARK(recorded_frame_over_bare_draw)->UseManualTime()->Unit(benchmark::kMillisecond);

void recorded_frame_of_meshes_over_bare_draw(benchmark::State& state) { measure_recorded_frames(state, true); }
BENCHMARK(recorded_frame_of_meshes_over_bare_draw)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace

Work make_recorded_frame_work() {
  return [cameras = std::make_shared<Cameras>(false)] {
    cameras->begin_file();
    cameras->record();
  };
}

}  // namespace rehearse
