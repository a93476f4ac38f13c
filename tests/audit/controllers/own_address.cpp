// Seeds its dither with its own address in memory.
#include "zoo.h"

#include <cstdint>

namespace {

class OwnAddress : public ZooController {
  double term() override { return 1e-9 * static_cast<double>(reinterpret_cast<std::uintptr_t>(this) % 1000003); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(OwnAddress)
