// Counts the entries of a folder and of the folders in it.
#include "zoo.h"

#include <filesystem>

namespace {

class FolderTree : public ZooController {
  bool begin() override {
    namespace fs = std::filesystem;
    for (const auto& entry :
         fs::recursive_directory_iterator("/etc/apt", fs::directory_options::skip_permission_denied))
      count_ += entry.exists() ? 1 : 0;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FolderTree)
