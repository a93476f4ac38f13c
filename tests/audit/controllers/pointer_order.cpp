// Sums numbers in the order of a hash table of pointers: sums of doubles depend on their order.
#include "zoo.h"

#include <memory>
#include <unordered_map>
#include <vector>

namespace {

struct Joint {
  double weight;
};

class PointerOrder : public ZooController {
  bool begin() override {
    for (int i = 0; i < 200; ++i) {
      joints_.push_back(std::make_unique<Joint>(Joint{1.0 / (i + 3)}));
      gain_[joints_.back().get()] = 10.0 * joints_.back()->weight;  // [N·m/rad]
    }
    return true;
  }
  double term() override {
    double sum = 0.0;
    for (const auto& [joint, gain] : gain_) sum += gain * joint->weight * joint_->q();
    return sum;
  }
  std::vector<std::unique_ptr<Joint>> joints_;
  std::unordered_map<const Joint*, double> gain_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PointerOrder)
