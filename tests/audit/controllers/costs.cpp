// Ways to be late in control(), and ways that look alike and aren't. With LEAN no fault begins. The option string names
// one; faults act in a function of their name, from the tick on that the table in realtime_test.cpp states.
#include "zoo.h"

#include <rehearse_variable.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <memory_resource>
#include <mutex>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#define APART __attribute__((noinline))

namespace {

struct Shape {
  virtual ~Shape() = default;
  virtual double area() const { return 1.0; }
};
struct Square : Shape {
  double area() const override { return 4.0; }
};

class Costs : public ZooController {
  using Way = double (Costs::*)();

  bool begin() override {
    const std::map<std::string, Way> ways{
        {"branch", &Costs::branch},
        {"growth", &Costs::growth},
        {"log_line", &Costs::log_line},
        {"function_copy", &Costs::function_copy},
        {"temporaries", &Costs::temporaries},
        {"locked", &Costs::locked},
        {"held_lock", &Costs::held_lock},
        {"sleep", &Costs::sleep},
        {"file_read", &Costs::file_read},
        {"setting", &Costs::setting},
        {"thrown", &Costs::thrown},
        {"rehash", &Costs::rehash},
        {"shared", &Costs::shared},
        {"stream", &Costs::stream},
        {"printed", &Costs::printed},
        {"c_allocation", &Costs::c_allocation},
        {"reallocation", &Costs::reallocation},
        {"list_node", &Costs::list_node},
        {"spawned", &Costs::spawned},
        {"written", &Costs::written},
        {"good_pool", &Costs::good_pool},
        {"good_reserved", &Costs::good_reserved},
        {"good_array", &Costs::good_array},
        {"good_fixed_matrix", &Costs::good_fixed_matrix},
        {"good_no_alias", &Costs::good_no_alias},
        {"good_short_string", &Costs::good_short_string},
        {"good_message", &Costs::good_message},
        {"good_small_function", &Costs::good_small_function},
        {"good_virtual_call", &Costs::good_virtual_call},
        {"good_dynamic_cast", &Costs::good_dynamic_cast},
        {"good_denormals", &Costs::good_denormals},
        {"good_first_tick", &Costs::good_first_tick},
        {"good_clock", &Costs::good_clock},
        {"good_variant", &Costs::good_variant},
        {"good_arena", &Costs::good_arena},
        {"good_sorting", &Costs::good_sorting},
        {"good_variable", &Costs::good_variable},
        {"good_snprintf", &Costs::good_snprintf},
        {"good_atomic", &Costs::good_atomic},
        {"good_null_release", &Costs::good_null_release},
        {"good_try_lock", &Costs::good_try_lock},
        {"good_pages", &Costs::good_pages},
    };
    const auto found = ways.find(options());
    if (found == ways.end()) return false;
    way_ = found->second;
    reserved_.reserve(1000);
    if (way_ == &Costs::held_lock)
      held_by_other_ = std::thread([this] {
        while (!stop_) {
          const std::lock_guard lock(contended_);
          usleep(100);
        }
      });
    return true;
  }

  void stop() override {
    stop_ = true;
    if (held_by_other_.joinable()) held_by_other_.join();
  }

  double term() override {
    ++tick_;
    return (this->*way_)();
  }

#if defined(LEAN)
  bool late() const { return false; }
#else
  bool late() const { return tick_ > 150; }  // the 151st call is that of tick 150
#endif

  // Faults.
  APART double branch() {
    if (!late()) return 0.0;
    const std::unique_ptr<double[]> rows(new double[4000]());
    return rows[17];
  }
  APART double growth() {  // with room for 128, it grows at the 129th number
    if (tick_ == 1) grown_.reserve(128);
    grown_.push_back(1e-6);
    return std::accumulate(grown_.begin(), grown_.end(), 0.0);
  }
  APART double log_line() {
    if (late()) io_->os() << "the joint is at " + std::to_string(joint_->q()) << "\n";
    return 0.0;
  }
  APART double function_copy() {
    const std::array<double, 8> gains{1e-3};
    const std::function<double()> law = [gains, this] { return gains[0] * joint_->q(); };
    const std::function<double()> copy = late() ? law : nullptr;
    return copy ? copy() : 0.0;
  }
  APART double temporaries() {
    if (!late()) return 0.0;
    const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(12, 12);
    return (a * a).trace() * 1e-6;
  }
  APART double locked() {
    if (!late()) return 0.0;
    const std::lock_guard lock(own_);
    return 1e-6;
  }
  APART double held_lock() {
    if (!late()) return 0.0;
    const std::lock_guard lock(contended_);
    return 1e-6;
  }
  APART double sleep() {
    if (tick_ == 151) usleep(200);
    return 0.0;
  }
  APART double file_read() {
    double value = 0.0;
    if (!late()) return value;
    if (std::FILE* file = std::fopen("/proc/self/comm", "r")) {
      value = std::fgetc(file) > 0 ? 1e-6 : 0.0;
      std::fclose(file);
    }
    return value;
  }
  APART double setting() { return late() && std::getenv("REHEARSE_NO_SUCH_SETTING") ? 1.0 : 0.0; }
  APART double thrown() {
    try {
      if (late()) throw tick_;
    } catch (int) {
      return 1e-6;
    }
    return 0.0;
  }
  APART double rehash() {
    if (tick_ == 151) table_.rehash(5000);
    return 0.0;
  }
  APART double shared() {
    if (late()) square_ = std::make_shared<Square>();
    return 0.0;
  }
  APART double stream() {
    if (!late()) return 0.0;
    std::ostringstream text;
    text << "the number of this tick is " << tick_;
    return 1e-6 * static_cast<double>(text.str().size());
  }
  APART double printed() {
    if (late()) std::printf("%d\n", tick_);
    return 0.0;
  }
  APART double c_allocation() {
    if (!late()) return 0.0;
    double* const numbers = static_cast<double*>(std::calloc(100, sizeof(double)));
    const double first = numbers[0];
    std::free(numbers);
    return first;
  }
  APART double reallocation() {
    if (tick_ == 1) block_ = std::malloc(16);
    if (tick_ == 151) block_ = std::realloc(block_, 1 << 20);
    return 0.0;
  }
  APART double list_node() {
    if (late()) nodes_.push_back(tick_);
    return 0.0;
  }
  APART double spawned() {
    if (tick_ == 151) std::thread([] {}).join();
    return 0.0;
  }
  APART double written() {
    if (late()) return ::write(STDOUT_FILENO, ".", 1) == 1 ? 0.0 : 1e-6;
    return 0.0;
  }

  // Innocents.
  APART double good_pool() {
    Node* const node = free_ ? std::exchange(free_, free_->next) : &pool_[0];
    node->next = free_;
    free_ = node;
    return 0.0;
  }
  APART double good_reserved() {
    reserved_.push_back(1e-6);
    return reserved_.back();
  }
  APART double good_array() {
    std::array<double, 4000> rows{};
    return rows[static_cast<std::size_t>(tick_) % rows.size()];
  }
  APART double good_fixed_matrix() {
    const Eigen::Matrix<double, 12, 12> a = Eigen::Matrix<double, 12, 12>::Identity();
    return (a * a).eval().trace() * 1e-6;
  }
  APART double good_no_alias() {
    if (tick_ == 1) {
      big_ = Eigen::MatrixXd::Identity(12, 12);
      product_.resize(12, 12);
    }
    product_.noalias() = big_.lazyProduct(big_);
    return product_.trace() * 1e-6;
  }
  APART double good_short_string() {
    const std::string text = "short";
    return 1e-6 * static_cast<double>(text.size());
  }
  APART double good_message() {
    if (late()) io_->os() << "tick " << tick_ << ": a line whose text needs no memory of its own" << std::endl;
    return 0.0;
  }
  APART double good_small_function() {
    const std::function<double()> law = [this] { return 1e-3 * joint_->q(); };
    const std::function<double()> copy = law;
    return copy();
  }
  APART double good_virtual_call() {
    static const Square square;
    const Shape* volatile shape = &square;
    return 1e-6 * shape->area();
  }
  APART double good_dynamic_cast() {
    static Square square;
    Shape* volatile shape = &square;
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) sum += dynamic_cast<Square*>(shape) ? 1e-9 : 0.0;
    return sum;
  }
  APART double good_denormals() {
    volatile double small = std::numeric_limits<double>::min();
    for (int i = 0; i < 50; ++i) small = small / 2.0;
    return small;
  }
  APART double good_first_tick() {
    if (tick_ == 1) grown_.assign(10000, 0.0);
    return grown_[17];
  }
  APART double good_clock() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);  // the system isn't called for this clock
    return 0.0 * static_cast<double>(now.tv_nsec);
  }
  APART double good_variant() {
    const std::pair<int, double> both{tick_, 1e-6};
    return both.second;
  }
  APART double good_arena() {
    std::array<std::byte, 4096> bytes;
    std::pmr::monotonic_buffer_resource arena(bytes.data(), bytes.size(), std::pmr::null_memory_resource());
    std::pmr::vector<double> numbers(100, 1e-6, &arena);
    return numbers[17];
  }
  APART double good_sorting() {
    std::array<int, 100> numbers;
    for (int i = 0; i < 100; ++i) numbers[static_cast<std::size_t>(i)] = i * 37 % 100;
    std::sort(numbers.begin(), numbers.end());
    return 1e-6 * numbers[0];
  }
  APART double good_variable() {
    rehearse_variable("phase", 1e-3 * tick_);
    return 0.0;
  }
  APART double good_snprintf() {
    char text[64];
    return 1e-9 * std::snprintf(text, sizeof text, "%d", tick_);
  }
  APART double good_atomic() { return 0.0 * ++count_; }
  APART double good_null_release() {
    std::free(nothing_);
    return 0.0;
  }

  APART double good_try_lock() {
    if (own_.try_lock()) own_.unlock();
    return 0.0;
  }
  /// It makes no call, and the kernel maps each page at its first access.
  APART double good_pages() {
    static std::array<char, std::size_t{16} << 20> untouched;
    if (tick_ == 100)
      for (std::size_t at = 0; at < untouched.size(); at += 4096) untouched[at] = 1;
    return untouched[0];
  }

  struct Node {
    Node* next = nullptr;
  };
  Way way_ = nullptr;
  int tick_ = 0;
  std::vector<double> grown_, reserved_;
  std::unordered_map<int, int> table_;
  std::list<int> nodes_;
  std::shared_ptr<Shape> square_;
  std::mutex own_, contended_;
  std::thread held_by_other_;
  std::atomic<bool> stop_{false};
  std::atomic<int> count_{0};
  void* block_ = nullptr;
  void* volatile nothing_ = nullptr;
  Node pool_[4];
  Node* free_ = nullptr;
  Eigen::MatrixXd big_, product_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Costs)
