// Scanner: the range sensors of a world's bodies, when they scan and when their scans arrive.
//
// The cycle is that of cameras: see renderer/vision.h. What a beam meets are collision shapes, in ODE: no renderer is
// needed, and what has no collision shape isn't seen. A sensor doesn't see what moves with it: the shapes of its own
// link and of those that fixed joints hold to it.
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
  /// `models`: one a body, in the order of the world's bodies. The world must outlive this.
  Scanner(const World& world, double time_step, const std::vector<std::shared_ptr<const Model>>& models);
  ~Scanner();
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Puts the scans that arrive at this tick into the observation, then scans what is due, in the world as it is now.
  /// To be called once for each tick, in order.
  void look(std::int64_t tick, Observation& observation);
  /// The next tick that is looked at, instead of the one after the last: scans go on in their cycle, but none that began
  /// before it arrives.
  void begin_at(std::int64_t tick);
  /// Controllers switch sensors on and off. Off: its scan is taken away. On again: it scans at the next tick.
  void switch_sensors(std::int64_t tick, const Command& command);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
