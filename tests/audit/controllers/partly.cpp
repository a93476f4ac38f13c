// Code of which a run executes a part: before the run, from a tick on, by the option string, or never. The marks are
// the names of the lines in coverage_test.cpp. It is compiled without optimisation.
#include "zoo.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

namespace {

double scale_of(int exponent) {
  return std::ldexp(1.0, exponent);  // static_initialiser
}

const double scale = scale_of(-30);

class Partly : public ZooController {
  bool begin() override {
    is_far_ = options() == "far";              // begin
    if (options() == "throw") throws_ = true;  // option_throw
    return true;
  }

  double term() override {
    ++tick_;
    if (tick_ == 101) late_ = late();
    if (is_far_) return far();  // one_way
    if (throws_ && tick_ == 21) fail();
    if (tick_ < 0) return never();
    return scale * (late_ + comparisons() + many_turns());
  }

  double late() {
    return 2.0;  // late
  }
  double far() {
    return scale * 3.0;  // far
  }
  double never() {
    const double sum = scale + late_;  // never
    return sum * sum;
  }
  void fail() {
    throw std::runtime_error("fails on purpose");  // fail
  }

  /// Conditional jumps of all kinds, each both ways; a wrong one changes the command.
  double comparisons() {
    std::uint32_t sum = 1;
    const double numbers[] = {-1.5, 0.0, 1.5, std::numeric_limits<double>::quiet_NaN()};
    for (const double a : numbers)
      for (const double b : numbers) {
        sum = sum * 31 + (a < b ? 1 : 2);
        sum = sum * 31 + (a <= b ? 1 : 2);
        if (a == b) sum += 7;
        if (a != b) sum += 9;
      }
    const int whole[] = {-2, -1, 0, 1, 2, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
    for (const int a : whole)
      for (const int b : whole) {
        const auto u = static_cast<unsigned>(a), v = static_cast<unsigned>(b);
        if (a < b) sum += 1;
        if (a <= b) sum += 2;
        if (a == b) sum += 4;
        if (u < v) sum += 8;
        if (u <= v) sum += 16;
        if (a < 0) sum += 32;
        int together = 0;
        if (__builtin_add_overflow(a, b, &together)) sum += 64;
        sum = sum * 31 + static_cast<unsigned>(together);
      }
    return sum % 1000;
  }

  /// A branch that goes one way more often than it is watched.
  double many_turns() {
    int odd = 0;
    for (int i = 0; i < 100; ++i)
      if (i < 0) ++odd;  // watched_in_part
    return odd;
  }

  bool is_far_ = false, throws_ = false;
  int tick_ = 0;
  double late_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Partly)
