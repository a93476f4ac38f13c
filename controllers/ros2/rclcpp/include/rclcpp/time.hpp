// Durations, times and clocks. Times of two kinds of clocks are not comparable.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>

#include <builtin_interfaces/msg/duration.hpp>
#include <builtin_interfaces/msg/time.hpp>

#include "rcl/types.h"
#include "rclcpp/macros.hpp"

namespace rehearse_ros2 {

/// Of a clock of this kind [ns]. Steady and system time are those of the C library. ROS time is steady time and a
/// constant: the date when the process read it first, or what set_ros_time() says.
std::int64_t read_clock(rcl_clock_type_t kind);
/// From now on ROS time goes on from `nanoseconds` since 1970. A host calls it as a run begins, so that ROS time is a
/// function of the tick.
void set_ros_time(std::int64_t nanoseconds);

}  // namespace rehearse_ros2

namespace rclcpp {

class Context;

class Duration {
 public:
  Duration() = default;
  Duration(std::int32_t seconds, std::uint32_t nanoseconds)
      : nanoseconds_(std::int64_t{seconds} * 1'000'000'000 + nanoseconds) {}
  explicit Duration(std::chrono::nanoseconds duration) : nanoseconds_(duration.count()) {}
  template <class Count, class Period>
  Duration(const std::chrono::duration<Count, Period>& duration)
      : Duration(std::chrono::duration_cast<std::chrono::nanoseconds>(duration)) {}
  Duration(const builtin_interfaces::msg::Duration& message) : Duration(message.sec, message.nanosec) {}
  explicit Duration(const rcl_duration_t& duration) : nanoseconds_(duration.nanoseconds) {}
  Duration(const Duration&) = default;
  virtual ~Duration() {}  // not trivial, as that of rclcpp: compilers else call variables of structures unused
  Duration& operator=(const Duration&) = default;
  Duration& operator=(const builtin_interfaces::msg::Duration& message) { return *this = Duration(message); }
  operator builtin_interfaces::msg::Duration() const;

  bool operator==(const Duration& other) const { return nanoseconds_ == other.nanoseconds_; }
  bool operator!=(const Duration& other) const { return nanoseconds_ != other.nanoseconds_; }
  bool operator<(const Duration& other) const { return nanoseconds_ < other.nanoseconds_; }
  bool operator<=(const Duration& other) const { return nanoseconds_ <= other.nanoseconds_; }
  bool operator>(const Duration& other) const { return nanoseconds_ > other.nanoseconds_; }
  bool operator>=(const Duration& other) const { return nanoseconds_ >= other.nanoseconds_; }
  /// Sums, differences and products that don't fit into 64 bits throw std::overflow_error or std::underflow_error.
  Duration operator+(const Duration& other) const;
  Duration operator-(const Duration& other) const;
  Duration operator*(double scale) const;
  Duration& operator+=(const Duration& other) { return *this = *this + other; }
  Duration& operator-=(const Duration& other) { return *this = *this - other; }
  Duration& operator*=(double scale) { return *this = *this * scale; }

  rcl_duration_value_t nanoseconds() const { return nanoseconds_; }
  double seconds() const { return static_cast<double>(nanoseconds_) / 1e9; }
  template <class Chrono>
  Chrono to_chrono() const {
    return std::chrono::duration_cast<Chrono>(std::chrono::nanoseconds(nanoseconds_));
  }
  rmw_time_t to_rmw_time() const;
  static Duration max() { return from_nanoseconds(std::numeric_limits<std::int64_t>::max()); }
  static Duration from_seconds(double seconds);
  static Duration from_nanoseconds(rcl_duration_value_t nanoseconds) {
    Duration duration;
    duration.nanoseconds_ = nanoseconds;
    return duration;
  }
  static Duration from_rmw_time(rmw_time_t duration);

 private:
  rcl_duration_value_t nanoseconds_ = 0;
};

class Time {
 public:
  Time(std::int32_t seconds, std::uint32_t nanoseconds, rcl_clock_type_t kind = RCL_SYSTEM_TIME);
  explicit Time(std::int64_t nanoseconds = 0, rcl_clock_type_t kind = RCL_SYSTEM_TIME)
      : nanoseconds_(nanoseconds), kind_(kind) {}
  Time(const builtin_interfaces::msg::Time& message, rcl_clock_type_t kind = RCL_ROS_TIME)
      : Time(message.sec, message.nanosec, kind) {}
  Time(const Time&) = default;
  virtual ~Time() {}  // as that of Duration
  Time& operator=(const Time&) = default;
  Time& operator=(const builtin_interfaces::msg::Time& message) { return *this = Time(message); }
  operator builtin_interfaces::msg::Time() const;

  /// Comparisons and differences of times of two kinds of clocks throw std::runtime_error.
  bool operator==(const Time& other) const { return compared(other) == 0; }
  bool operator!=(const Time& other) const { return compared(other) != 0; }
  bool operator<(const Time& other) const { return compared(other) < 0; }
  bool operator<=(const Time& other) const { return compared(other) <= 0; }
  bool operator>(const Time& other) const { return compared(other) > 0; }
  bool operator>=(const Time& other) const { return compared(other) >= 0; }
  Time operator+(const Duration& duration) const;
  Time operator-(const Duration& duration) const;
  Duration operator-(const Time& other) const;
  Time& operator+=(const Duration& duration) { return *this = *this + duration; }
  Time& operator-=(const Duration& duration) { return *this = *this - duration; }

  rcl_time_point_value_t nanoseconds() const { return nanoseconds_; }
  double seconds() const { return static_cast<double>(nanoseconds_) / 1e9; }
  rcl_clock_type_t get_clock_type() const { return kind_; }
  static Time max(rcl_clock_type_t kind = RCL_SYSTEM_TIME) {
    return Time(std::numeric_limits<std::int64_t>::max(), kind);
  }

 private:
  int compared(const Time& other) const;
  rcl_time_point_value_t nanoseconds_;
  rcl_clock_type_t kind_;
};

inline Time operator+(const Duration& duration, const Time& time) { return time + duration; }
builtin_interfaces::msg::Time convert_rcl_time_to_sec_nanos(const rcl_time_point_value_t& nanoseconds);

/// Copies are the same clock.
class Clock {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Clock)
  explicit Clock(rcl_clock_type_t kind = RCL_SYSTEM_TIME) : kind_(kind) {}
  virtual ~Clock() = default;
  Time now() const { return Time(rehearse_ros2::read_clock(kind_), kind_); }
  /// False: the context was shut down before. Throws std::runtime_error if the time is of another kind of clock.
  bool sleep_until(Time until, std::shared_ptr<Context> context = nullptr);
  bool sleep_for(Duration duration, std::shared_ptr<Context> context = nullptr);
  bool started() { return true; }
  bool wait_until_started(std::shared_ptr<Context> = nullptr) { return true; }
  bool wait_until_started(const Duration&, std::shared_ptr<Context> = nullptr) { return true; }
  bool ros_time_is_active() const { return shared_->simulated; }
  rcl_clock_type_t get_clock_type() const noexcept { return kind_; }
  std::mutex& get_clock_mutex() noexcept { return shared_->mutex; }
  /// Called with the value of use_sim_time.
  void rehearse_set_simulated(bool simulated) { shared_->simulated = simulated; }

 private:
  struct Shared {
    std::atomic<bool> simulated{false};
    std::mutex mutex;
  };
  rcl_clock_type_t kind_;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

class RateBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(RateBase)
  virtual ~RateBase() = default;
  virtual bool sleep() = 0;
  virtual rcl_clock_type_t get_type() const = 0;
  virtual void reset() = 0;
};

class Rate : public RateBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Rate)
  explicit Rate(double frequency, Clock::SharedPtr clock = std::make_shared<Clock>(RCL_SYSTEM_TIME));
  explicit Rate(const Duration& period, Clock::SharedPtr clock = std::make_shared<Clock>(RCL_SYSTEM_TIME));
  /// False: the time has passed already, so it didn't sleep.
  bool sleep() override;
  rcl_clock_type_t get_type() const override { return clock_->get_clock_type(); }
  void reset() override { last_ = clock_->now(); }
  Duration period() const { return period_; }

 private:
  Clock::SharedPtr clock_;
  Duration period_;
  Time last_;
};

class WallRate : public Rate {
 public:
  explicit WallRate(double frequency) : Rate(frequency, std::make_shared<Clock>(RCL_STEADY_TIME)) {}
  explicit WallRate(const Duration& period) : Rate(period, std::make_shared<Clock>(RCL_STEADY_TIME)) {}
};
class ROSRate : public Rate {
 public:
  explicit ROSRate(double frequency) : Rate(frequency, std::make_shared<Clock>(RCL_ROS_TIME)) {}
  explicit ROSRate(const Duration& period) : Rate(period, std::make_shared<Clock>(RCL_ROS_TIME)) {}
};

}  // namespace rclcpp
