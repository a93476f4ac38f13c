// A library that changes the process while it is loaded or unloaded, as the variable LOADS_BADLY requires.
#include <cnoid/SimpleController>
#include <cstdlib>
#include <string>

#include <unistd.h>

namespace {

void hang() {
  for (volatile int forever = 0;; forever = 1 - forever) {
  }
}

void crash() {
  volatile int* volatile nowhere = nullptr;
  *nowhere = 1;
}

struct AtLoading {
  std::string deed = std::getenv("LOADS_BADLY") ? std::getenv("LOADS_BADLY") : "";
  AtLoading() {
    if (deed == "exit") std::exit(4);
    if (deed == "chdir") static_cast<void>(chdir("/"));
    if (deed == "crash") crash();
    if (deed == "hang") hang();
    if (deed == "exit_in_atexit") std::atexit([] { std::exit(4); });
  }
  ~AtLoading() {
    if (deed == "exit_at_end") std::exit(4);
    if (deed == "crash_at_end") crash();
    if (deed == "hang_at_end") hang();
  }
};
const AtLoading at_loading;

class LoadsBadly : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO*) override { return true; }
  bool control() override { return true; }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LoadsBadly)
