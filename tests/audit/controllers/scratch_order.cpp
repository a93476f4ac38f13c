// Goes by the order in which a folder of its own is listed.
#include "zoo.h"

#include <filesystem>
#include <fstream>

namespace {

class ScratchOrder : public ZooController {
  bool begin() override {
    std::filesystem::create_directory("zoo_order");
    for (const char* name : {"b", "d", "a", "c"}) std::ofstream(std::string("zoo_order/") + name) << name;
    for (const auto& entry : std::filesystem::directory_iterator("zoo_order"))
      order_ = 10.0 * order_ + entry.path().filename().string()[0];
    return true;
  }
  double term() override { return 1e-9 * order_; }
  double order_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScratchOrder)
