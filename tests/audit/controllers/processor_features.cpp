// Computes differently on processors with AVX2.
#include "zoo.h"

namespace {

class ProcessorFeatures : public ZooController {
  double term() override { return __builtin_cpu_supports("avx2") ? -0.1 * joint_->q() : -0.2 * joint_->q(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ProcessorFeatures)
