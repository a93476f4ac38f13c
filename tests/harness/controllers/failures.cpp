// Controllers that fail, each in a different way.

#include <unistd.h>
#include <xmmintrin.h>

#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "behaviours.h"

namespace behaviours {
namespace {

/// Recurses until the stack is used up.
int overflow(int depth) {
  volatile char room[4096];
  room[0] = static_cast<char>(depth);
  return depth < 0 ? 0 : overflow(depth + 1) + room[0];
}

void hang() {
  for (volatile int forever = 0;; forever = 1 - forever) {
  }
}

/// fail HOW FUNCTION [TICK]: commands 1 N·m, and fails in that function (control: in that tick, counted from 0).
class Failure : public Pusher {
 public:
  explicit Failure(const Words& words)
      : Pusher(1.0), how_(words.at(0)), where_(words.at(1)), when_(words.size() > 2 ? std::stoi(words[2]) : 0) {}
  bool configure(cnoid::SimpleControllerConfig*) override { return fail_in("configure"); }
  bool initialize(cnoid::SimpleControllerIO* io) override {
    Pusher::initialize(io);
    return fail_in("initialize");
  }
  bool start() override { return fail_in("start"); }
  bool control() override {
    const bool now = tick_ == when_;
    Pusher::control();
    return now ? fail_in("control") : true;
  }
  void stop() override { fail_in("stop"); }

 private:
  bool fail_in(const std::string& function) {
    if (function == where_) fail();
    return true;
  }
  void fail() {
    if (how_ == "throw") throw std::runtime_error("no gait for this slope");
    if (how_ == "throw_int") throw 42;
    if (how_ == "null") io_->body()->link("NO_SUCH_LINK")->q() = 1.0;
    if (how_ == "null_input") io_->enableInput(static_cast<cnoid::Link*>(nullptr));
    if (how_ == "abort") std::abort();
    if (how_ == "exit") std::exit(0);
    if (how_ == "_exit") _exit(3);
    if (how_ == "quick_exit") std::quick_exit(1);
    if (how_ == "overflow") shoulder_->u() = overflow(0);
    if (how_ == "hang") hang();
    if (how_ == "nan") shoulder_->u() = std::numeric_limits<double>::quiet_NaN();
    if (how_ == "infinity") shoulder_->u() = -std::numeric_limits<double>::infinity();
    if (how_ == "flush") _mm_setcsr(_mm_getcsr() | 0x8040);  // flush to zero, denormals are zero: what -ffast-math does
    if (how_ == "explode") shoulder_->u() = 1e308;
  }
  std::string how_, where_;
  int when_;
};
const Add<Failure> failure("fail");

/// Commands an effort of SHOULDER that shows whether arithmetic supports denormal numbers.
class DenormalTester : public Pusher {
 public:
  explicit DenormalTester(const Words&) : Pusher(0.0) {}
  bool control() override {
    volatile double tiny = std::numeric_limits<double>::min();
    effort_ = tiny / 2.0 > 0.0 ? 1.0 : 0.0;
    return Pusher::control();
  }
};
const Add<DenormalTester> denormal_tester("denormals");

}  // namespace
}  // namespace behaviours
