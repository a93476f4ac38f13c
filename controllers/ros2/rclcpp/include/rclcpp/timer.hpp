// Timers.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/time.hpp"

namespace rclcpp {

struct TimerInfo {
  Time expected_call_time;
  Time actual_call_time;
};

class TimerBase : public rehearse_ros2::Entity {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(TimerBase)
  /// Throws std::invalid_argument if the period is negative.
  TimerBase(Clock::SharedPtr clock, std::chrono::nanoseconds period, Context::SharedPtr context, bool starts = true);
  void cancel();
  bool is_canceled();
  /// Begins a new period now.
  void reset();
  bool is_ready();
  bool is_steady() { return clock_->get_clock_type() == RCL_STEADY_TIME; }
  Clock::SharedPtr get_clock() const { return clock_; }
  std::chrono::nanoseconds get_period() const { return std::chrono::nanoseconds(period_); }
  /// The greatest duration if it is cancelled; negative if it is late.
  std::chrono::nanoseconds time_until_trigger();
  /// Begins the next period, and states the times of this call; nothing if it was cancelled meanwhile.
  std::optional<TimerInfo> rehearse_call();
  virtual void execute_callback(const TimerInfo& info) = 0;

  bool rehearse_ready(std::int64_t now) override { return rehearse_due(now) <= now; }
  std::int64_t rehearse_due(std::int64_t now) override;
  void rehearse_execute() override;

 private:
  std::int64_t clock_now() const { return rehearse_ros2::read_clock(clock_->get_clock_type()); }
  Clock::SharedPtr clock_;
  std::int64_t period_;  // [ns]
  std::int64_t next_;    // of its clock [ns]
  bool is_canceled_;
};

template <class Callback>
class GenericTimer : public TimerBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(GenericTimer)
  GenericTimer(Clock::SharedPtr clock, std::chrono::nanoseconds period, Callback&& callback,
               Context::SharedPtr context = nullptr, bool starts = true)
      : TimerBase(std::move(clock), period, std::move(context), starts), callback_(std::move(callback)) {}
  void execute_callback(const TimerInfo& info) override {
    if constexpr (std::is_invocable_v<Callback&, TimerBase&>)
      callback_(*this);
    else if constexpr (std::is_invocable_v<Callback&, const TimerInfo&>)
      callback_(info);
    else
      callback_();
    (void)info;
  }

 private:
  std::decay_t<Callback> callback_;
};

template <class Callback>
class WallTimer : public GenericTimer<Callback> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(WallTimer)
  WallTimer(std::chrono::nanoseconds period, Callback&& callback, Context::SharedPtr context = nullptr,
            bool starts = true)
      : GenericTimer<Callback>(std::make_shared<Clock>(RCL_STEADY_TIME), period, std::move(callback),
                               std::move(context), starts) {}
};

}  // namespace rclcpp
