// Goes by the first entry of a folder.
#include "zoo.h"

#include <filesystem>

namespace {

class FirstEntry : public ZooController {
  bool begin() override {
    const std::filesystem::path folder = std::filesystem::path(options()).parent_path();
    first_ = std::filesystem::directory_iterator(folder)->path().filename().string()[0];
    return true;
  }
  double term() override { return 1e-9 * first_; }
  int first_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FirstEntry)
