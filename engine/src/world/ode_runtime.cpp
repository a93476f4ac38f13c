#include "ode_runtime.h"

#include <rehearse/diagnostic.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <utility>

#include "ode_math.h"

namespace rehearse {
namespace {

struct StepBrokeOff {};

bool stepping = false;
constexpr std::size_t most_messages = 16;  // between two calls of take_ode_messages()

/// ODE calls this when one of its assertions fails, and aborts if it returns. In a step the cause is numbers that are
/// not finite: everything else is checked when a world is made.
void on_failed_assertion(int, const char* message, va_list arguments) {
  if (stepping) throw StepBrokeOff{};
  std::vfprintf(stderr, message, arguments);
  std::fputc('\n', stderr);
}

/// ODE calls this with "LCP internal error" and similar messages: it found no solution for a step and continues with an
/// approximation.
std::vector<std::string> messages;

void on_message(int number, const char* message, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, message, arguments);
  std::string told = "ODE message " + std::to_string(number) + ": " + text;
  if (messages.size() < most_messages && std::ranges::find(messages, told) == messages.end())
    messages.push_back(std::move(told));
}

}  // namespace

std::vector<std::string> take_ode_messages() { return std::exchange(messages, {}); }

void initialise_ode() {
  static const bool done = [] {
    dSetDebugHandler(on_failed_assertion);
    dSetMessageHandler(on_message);
    return dInitODE2(0) != 0;
  }();
  REHEARSE_ASSERT(done, "ODE initialises");
}

OwnJobs::OwnJobs(dWorldID world) : jobs_(dThreadingAllocateSelfThreadedImplementation()) {
  dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(jobs_), jobs_);
}

OwnJobs::~OwnJobs() { dThreadingFreeImplementation(jobs_); }

namespace {

/// Calls `use` with each number array of a body's motion and its size.
template <class Use>
void visit_motion(dBodyID body, Use use) {
  visit_pose(body, use);
  use(dBodyGetLinearVel(body), 3);
  use(dBodyGetAngularVel(body), 3);
}

}  // namespace

OdeMotions::OdeMotions(const std::vector<dBodyID>& bodies) {
  for (const dBodyID body : bodies) {
    Motion& motion = motions_.emplace_back();
    motion.body = body;
    dReal* place = motion.numbers;
    visit_motion(body, [&](const dReal* numbers, int count) {
      std::memcpy(place, numbers, count * sizeof(dReal));
      place += count;
    });
    std::memcpy(motion.force, dBodyGetForce(body), sizeof motion.force);
    std::memcpy(motion.torque, dBodyGetTorque(body), sizeof motion.torque);
  }
}

void OdeMotions::restore() const {
  for (const Motion& motion : motions_) {
    const dReal* place = motion.numbers;
    visit_motion(motion.body, [&](const dReal* numbers, int count) {
      std::memcpy(const_cast<dReal*>(numbers), place, count * sizeof(dReal));
      place += count;
    });
    dBodySetForce(motion.body, motion.force[0], motion.force[1], motion.force[2]);
    dBodySetTorque(motion.body, motion.torque[0], motion.torque[1], motion.torque[2]);
  }
}

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
