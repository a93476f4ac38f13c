// Vision: the cameras of a world's bodies, when they look and when their pictures arrive.
//
// A camera that is on captures at tick 0 and then at the first tick at or after each multiple of its period; a picture
// arrives one period later, but no more than a second, at the first tick at or after it (Choreonoid's vision cycle, in
// its form that always waits). Example: 30 Hz at 1 ms: captured at tick 0, seen by controllers at tick 34, captured
// again at tick 34. All of it follows from the tick number alone. Drawing is done here too; needs OSMesa.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/renderer.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

class Vision {
 public:
  /// `models`: one a body, in the order of Observation::bodies. `active`: for each body, for each device, whether it is
  /// a camera that runs. The bodies' lights shine into all pictures. Fails if no picture can be drawn on this machine,
  /// or if there are more lights than a picture can have.
  static Result<std::unique_ptr<Vision>> create(double time_step, std::vector<std::shared_ptr<const Model>> models,
                                                std::vector<std::vector<bool>> active, const Look& look = {});
  ~Vision();
  Vision(const Vision&) = delete;
  Vision& operator=(const Vision&) = delete;

  /// Puts the pictures that arrive at this tick into the observation, then captures those that are due, from the poses
  /// in it. To be called once for each tick, in order.
  void look(std::int64_t tick, Observation& observation);
  /// The next tick that is looked at, instead of the one after the last: captures go on in their cycle, but no picture
  /// that was captured before it arrives.
  void begin_at(std::int64_t tick);
  /// What controllers said in this tick to cameras and lights. A camera that is switched off loses its picture; on
  /// again it captures at the next tick. A light is in its new state from the next capture on. Tick -1: before the run.
  void obey(std::int64_t tick, const Command& command);

  /// Draws the bodies where the observation says they are, from any place, for people: with shadows and smooth edges.
  Frame draw(const Camera& camera, const Eigen::Isometry3d& pose, const Observation& observation);

  /// What the pixels depend on.
  std::string renderer_description() const;

 private:
  Vision();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
