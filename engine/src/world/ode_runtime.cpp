#include "ode_runtime.h"

#include <rehearse/diagnostic.h>

#include <cstdarg>
#include <cstdio>

namespace rehearse {
namespace {

struct StepBrokeOff {};

bool stepping = false;

/// ODE calls this when an assertion of its own fails, and aborts if it returns. In a step that means numbers that are
/// not finite: all else is checked when a world is made.
void on_failed_assertion(int, const char* message, va_list arguments) {
  if (stepping) throw StepBrokeOff{};
  std::vfprintf(stderr, message, arguments);
  std::fputc('\n', stderr);
}

}  // namespace

void initialise_ode() {
  static const bool done = [] {
    dSetDebugHandler(on_failed_assertion);
    return dInitODE2(0) != 0;
  }();
  REHEARSE_ASSERT(done, "ODE initialises");
}

OwnJobs::OwnJobs(dWorldID world) : jobs_(dThreadingAllocateSelfThreadedImplementation()) {
  dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(jobs_), jobs_);
}

OwnJobs::~OwnJobs() { dThreadingFreeImplementation(jobs_); }

bool step_ode(dWorldID world, double time_step, bool quick) {
  stepping = true;
  bool done = true;
  try {
    if (quick)
      dWorldQuickStep(world, time_step);
    else
      dWorldStep(world, time_step);
  } catch (const StepBrokeOff&) {
    done = false;
  }
  stepping = false;
  return done;
}

}  // namespace rehearse
