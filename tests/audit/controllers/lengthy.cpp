// Ways in which control() takes long without any call, and ways that look alike and have equal instructions in each
// tick. The option string names one; the long ones act in a function of their name, in tick 150.
#include "zoo.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#define APART __attribute__((noinline))

namespace {

struct Shape {
  virtual ~Shape() = default;
  virtual double area() const { return 1.0; }
};
struct Square : Shape {
  double area() const override { return 4.0; }
};

class Lengthy : public ZooController {
  using Way = double (Lengthy::*)();

  bool begin() override {
    const std::map<std::string, Way> ways{{"input_loop", &Lengthy::input_loop},
                                          {"busy_wait", &Lengthy::busy_wait},
                                          {"quadratic_search", &Lengthy::quadratic_search},
                                          {"many_casts", &Lengthy::many_casts},
                                          {"many_sines", &Lengthy::many_sines},
                                          {"good_denormals", &Lengthy::good_denormals},
                                          {"good_first_touch", &Lengthy::good_first_touch},
                                          {"good_deep_stack", &Lengthy::good_deep_stack},
                                          {"good_cold_call", &Lengthy::good_cold_call}};
    way_ = ways.at(options());
    touched_.resize(std::size_t{1} << 22);
    return true;
  }

  double term() override {
    acts_ = ++tick_ == 151;
    return (this->*way_)();
  }

  /// Repeats until the step is as small as the angle asks for.
  APART double input_loop() {
    const double least = acts_ ? 1e-9 * std::abs(joint_->q()) : 0.1;
    double sum = 0.0;
    for (double step = 1.0; step > least; step *= acts_ ? 0.999 : 0.5) sum += step * step;
    return 1e-9 * sum;
  }
  APART double busy_wait() {
    for (int i = acts_ ? 100'000 : 10; i > 0; --i) waited_ = i;
    return 0.0;
  }
  APART double quadratic_search() {
    const int size = acts_ ? 300 : 3;
    int pairs = 0;
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) pairs += (i * 7919 + j) % 31 == 0 ? 1 : 0;
    return 1e-9 * pairs;
  }
  APART double many_casts() {
    int squares = 0;
    for (int i = acts_ ? 1000 : 1; i > 0; --i) squares += dynamic_cast<const Square*>(shape_) ? 1 : 0;
    return 1e-9 * squares;
  }
  APART double many_sines() {
    double sum = 0.0;
    for (int i = acts_ ? 1000 : 1; i > 0; --i) sum += std::sin(0.001 * i + joint_->q());
    return 1e-9 * sum;
  }
  /// Takes longer by the clock in tick 150, by as many instructions.
  APART double good_denormals() {
    const double starts[] = {1.0, std::numeric_limits<double>::denorm_min()};
    volatile double small = starts[acts_ ? 1 : 0];
    for (int i = 0; i < 100; ++i) small = small * 0.75;
    return 0.0;
  }
  APART double good_first_touch() {
    touched_[static_cast<std::size_t>(tick_) * 4096] = 1;  // a page of its own in each tick
    return 0.0;
  }
  APART double good_deep_stack() {
    std::array<volatile char, 200'000> local;
    local[static_cast<std::size_t>(tick_)] = 1;
    return 0.0 * local[static_cast<std::size_t>(tick_)];
  }
  APART double good_cold_call() { return 1e-9 * shape_->area(); }

  Way way_ = nullptr;
  int tick_ = 0;
  bool acts_ = false;
  volatile int waited_ = 0;
  Square square_;
  const Shape* volatile shape_ = &square_;
  std::vector<char> touched_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Lengthy)
