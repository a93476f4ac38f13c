// Creates a folder, stores the last ticks in files there, and sums up the files in the folder's list.
#include "zoo.h"

#include <filesystem>
#include <fstream>

namespace {

class ScratchFolder : public ZooController {
  bool begin() override {
    std::filesystem::remove_all("zoo_ticks");
    return true;
  }
  double term() override {
    namespace fs = std::filesystem;
    fs::create_directories("zoo_ticks");
    std::ofstream("zoo_ticks/" + std::to_string(tick_ % 4)) << tick_ << '\n';
    ++tick_;
    int sum = 0, number = 0;
    for (const auto& entry : fs::directory_iterator("zoo_ticks"))
      if (std::ifstream(entry.path()) >> number) sum += number;
    return 1e-6 * sum;
  }
  int tick_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScratchFolder)
