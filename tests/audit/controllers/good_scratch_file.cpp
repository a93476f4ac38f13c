// Writes a file into the working folder, and reads it back.
#include "zoo.h"

#include <fstream>

namespace {

class ScratchFile : public ZooController {
  double term() override {
    std::ofstream("scratch.txt") << std::hexfloat << joint_->q() << '\n';
    std::ifstream file("scratch.txt");
    std::string text;
    file >> text;
    return -0.1 * std::strtod(text.c_str(), nullptr);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ScratchFile)
