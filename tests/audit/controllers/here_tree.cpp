// Counts the entries of a folder in the working folder, and of the folders in it.
#include "zoo.h"

#include <filesystem>

namespace {

class HereTree : public ZooController {
  bool begin() override {
    std::error_code failed;
    for (const auto& entry : std::filesystem::recursive_directory_iterator("zoo_tree", failed))
      count_ += entry.path().empty() ? 0 : 1;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HereTree)
