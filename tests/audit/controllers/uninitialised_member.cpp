// Does not initialise one of its members.
#include "zoo.h"

namespace {

class UninitialisedMember : public ZooController {
 public:
  UninitialisedMember() {}

 private:
  double term() override { return 1e-3 * offset_; }
  double offset_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UninitialisedMember)
