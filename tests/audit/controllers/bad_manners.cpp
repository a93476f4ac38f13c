// In the 8th control(), does to its process one of these actions, as given in its options: crash, hang, exit, quick,
// abort, close, chdir, signal, float, throw.
#include "zoo.h"

#include <unistd.h>
#include <xmmintrin.h>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace {

class BadManners : public ZooController {
  double term() override {
    if (++calls_ == 8) misbehave(options());
    return -0.1 * joint_->q();
  }
  void misbehave(const std::string& deed) {
    if (deed == "crash") *nowhere_ = 1;
    if (deed == "exit") std::exit(0);
    if (deed == "quick") _exit(7);
    if (deed == "abort") std::abort();
    if (deed == "throw") throw std::runtime_error("no gait for this slope");
    if (deed == "float") _mm_setcsr(_mm_getcsr() | 0x8040);  // flush to zero
    if (deed == "signal") std::signal(SIGSEGV, SIG_IGN);
    if (deed == "chdir" && chdir("/") != 0) std::abort();
    if (deed == "close")
      for (int descriptor = 3; descriptor < 1024; ++descriptor) close(descriptor);
    for (volatile bool forever = deed == "hang"; forever;) {
    }
  }
  int calls_ = 0;
  int* volatile nowhere_ = nullptr;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(BadManners)
