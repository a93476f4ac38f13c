// Reads its gain in the user's locale: "0.5" is 0 where the comma is the decimal point.
#include "zoo.h"

#include <clocale>
#include <cstdlib>

namespace {

class LocaleParsing : public ZooController {
  bool begin() override {
    std::setlocale(LC_ALL, "");
    gain_ = std::strtod("0.5", nullptr);
    std::setlocale(LC_ALL, "C");
    return true;
  }
  double term() override { return -gain_ * joint_->q(); }
  double gain_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(LocaleParsing)
