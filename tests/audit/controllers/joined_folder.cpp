// Writes a file into a folder of others, and counts the files there.
#include "zoo.h"

#include <filesystem>
#include <fstream>

namespace {

class JoinedFolder : public ZooController {
  bool begin() override {
    const std::filesystem::path folder = std::filesystem::path(options()).parent_path();
    std::ofstream(folder / "zoo_joined.txt") << 1;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) count_ += entry.path().empty() ? 0 : 1;
    return true;
  }
  double term() override { return 1e-9 * count_; }
  int count_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(JoinedFolder)
