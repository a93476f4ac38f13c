// Scanner: the range sensors of a world's bodies. It scans and delivers the scans at the right ticks.
//
// The cycle is that of cameras: see renderer/vision.h. Beams are intersected with collision shapes in ODE: no renderer
// is needed, and links without collision shapes aren't seen. A sensor doesn't see shapes that move with it: those of
// its own link and of links that fixed joints connect to it.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/world.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace rehearse {

class Scanner {
 public:
  /// `models`: one per body, in the order of the world's bodies. The world must outlive this.
  Scanner(const World& world, double time_step, const std::vector<std::shared_ptr<const Model>>& models);
  ~Scanner();
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Puts the scans that arrive at this tick into the observation. Then makes the scans that are due, in the current
  /// state of the world. To be called once for each tick, in order.
  void look(std::int64_t tick, Observation& observation);
  /// Makes `tick` the next tick for look(), instead of the one after the last. Scans continue in their cycle, but scans
  /// that were made before `tick` don't arrive.
  void begin_at(std::int64_t tick);
  /// Switches sensors on and off as controllers command. Off: the sensor's scan is removed. On again: it scans at the
  /// next tick.
  void switch_sensors(std::int64_t tick, const Command& command);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
