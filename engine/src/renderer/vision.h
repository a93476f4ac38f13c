// Vision: the cameras of a world's bodies. It draws their pictures and delivers them at the right ticks.
//
// A camera that is on captures at tick 0 and then at the first tick at or after each multiple of its period; a picture
// arrives one period later, but no more than a second, at the first tick at or after it (Choreonoid's vision cycle, in
// its form that always waits). Example: 30 Hz at 1 ms: captured at tick 0, seen by controllers at tick 34, captured
// again at tick 34. The cycle depends on the tick number alone. A picture with an exposure is drawn in several ticks
// from its capture on (exposure.h). Drawing needs OSMesa.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/renderer.h>
#include <rehearse/world_settings.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

class Vision {
 public:
  /// `models`: one per body, in the order of Observation::bodies. `active`: for each body and device, true if it is a
  /// camera that runs. The bodies' lights shine into all pictures. Fails if the renderer can't be created on this
  /// machine, or if there are more than Renderer::max_lights lights.
  static Result<std::unique_ptr<Vision>> create(double time_step, std::vector<std::shared_ptr<const Model>> models,
                                                std::vector<std::vector<bool>> active, const Look& look = {});
  ~Vision();
  Vision(const Vision&) = delete;
  Vision& operator=(const Vision&) = delete;

  /// Puts the pictures that arrive at this tick into the observation. Then captures the pictures that are due, with the
  /// poses in the observation. To be called once for each tick, in order.
  void look(std::int64_t tick, Observation& observation);
  /// Makes `tick` the next tick for look(), instead of the one after the last. Captures continue in their cycle, but
  /// pictures that were captured before `tick` don't arrive.
  void begin_at(std::int64_t tick);
  /// Executes the commands of this tick to cameras and lights. A camera that is switched off loses its picture; when it
  /// is switched on again, it captures at the next tick. A light has its new state from the next capture on. Tick -1
  /// means before the run.
  void obey(std::int64_t tick, const Command& command);

  /// Draws the bodies at their poses in the observation, from any camera pose, in fine quality: with shadows and smooth
  /// edges.
  Frame draw(const Camera& camera, const Eigen::Isometry3d& pose, const Observation& observation);

  /// The versions on which the pixels depend; see Renderer::description().
  std::string renderer_description() const;

 private:
  Vision();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
