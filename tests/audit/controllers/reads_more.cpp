// Reads the pose of its link, which recordings of the other controllers don't contain.
#include "zoo.h"

namespace {

class ReadsMore : public ZooController {
  bool begin() override {
    io_->enableInput(joint_, cnoid::Link::LinkPosition);
    return true;
  }
  double term() override { return -0.1 * joint_->translation().z(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ReadsMore)
