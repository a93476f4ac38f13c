// What ODE keeps once for the whole process, made safe for several worlds in it. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <cstdint>

namespace rehearse {

/// ODE's process-wide set-up, once, before the first world.
void initialise_ode();

/// ODE has one random generator for the process. While this lives, it is the world's; after it, it is as it was.
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

/// The jobs into which ODE divides a step, done one after the other by the thread that steps. ODE shares one such list
/// between all worlds; with a list of its own, a world whose step broke off leaves nothing in the others' way.
class OwnJobs {
 public:
  explicit OwnJobs(dWorldID world);
  ~OwnJobs();
  OwnJobs(const OwnJobs&) = delete;
  OwnJobs& operator=(const OwnJobs&) = delete;

 private:
  dThreadingImplementationID jobs_;
};

/// Calls dWorldQuickStep or dWorldStep. False if ODE broke off because its numbers were no longer finite, where it
/// would abort the process; the world must not be stepped or destroyed then, only left alone.
bool step_ode(dWorldID world, double time_step, bool quick);

}  // namespace rehearse
