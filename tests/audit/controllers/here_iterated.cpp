// Counts the entries of the working folder by an iterator.
#include "zoo.h"

#include <filesystem>

namespace {

class HereIterated : public ZooController {
  bool begin() override {
    for (const auto& entry : std::filesystem::directory_iterator(".")) count_ += entry.path().empty() ? 0 : 1;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HereIterated)
