// Counts the entries of a folder.
#include "zoo.h"

#include <filesystem>

namespace {

class FolderList : public ZooController {
  bool begin() override {
    for (const auto& entry : std::filesystem::directory_iterator("/etc")) count_ += entry.exists() ? 1 : 0;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FolderList)
