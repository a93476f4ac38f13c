// ODE's data that exist once per process, made safe for several worlds. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <cstdint>
#include <string>
#include <vector>

namespace rehearse {

/// ODE's process-wide set-up, once, before the first world.
void initialise_ode();

/// ODE has one random generator for the process. During the lifetime of this object the generator has the world's seed;
/// the destructor restores the previous one.
class OwnRandom {
 public:
  explicit OwnRandom(std::uint64_t& seed) : seed_(seed), outside_(dRandGetSeed()) {
    dRandSetSeed(static_cast<unsigned long>(seed_));
  }
  ~OwnRandom() {
    seed_ = dRandGetSeed();
    dRandSetSeed(outside_);
  }
  OwnRandom(const OwnRandom&) = delete;
  OwnRandom& operator=(const OwnRandom&) = delete;

 private:
  std::uint64_t& seed_;
  unsigned long outside_;
};

/// The list of jobs into which ODE divides a step; the stepping thread executes them one after the other. By default
/// ODE shares one list between all worlds. With a separate list, an aborted step of one world doesn't affect other
/// worlds.
class OwnJobs {
 public:
  explicit OwnJobs(dWorldID world);
  ~OwnJobs();
  OwnJobs(const OwnJobs&) = delete;
  OwnJobs& operator=(const OwnJobs&) = delete;

 private:
  dThreadingImplementationID jobs_;
};

/// The messages of ODE since the last call, each text once, the first 16: "ODE message 3: LCP internal error, s <= 0".
/// They report that ODE found no solution and continued with an approximation. ODE doesn't report the world of a
/// message, so call this after each step. Without messages a call is cheap.
std::vector<std::string> take_ode_messages();

/// The motions of ODE's bodies, and the forces on them.
class OdeMotions {
 public:
  explicit OdeMotions(const std::vector<dBodyID>& bodies);
  /// Sets the bodies' motions and forces to those at construction, bit by bit.
  void restore() const;

 private:
  struct Motion {
    dBodyID body;
    dReal numbers[25];  // position, quaternion, rotation, velocity, angular velocity
    dVector3 force, torque;
  };
  std::vector<Motion> motions_;
};

/// Calls dWorldQuickStep or dWorldStep. Returns false if ODE stopped because its numbers were no longer finite (ODE
/// itself would abort the process). Then the world must be neither stepped nor destroyed.
bool step_ode(dWorldID world, double time_step, bool quick);

}  // namespace rehearse
