#include "rclcpp/time.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "rclcpp/detail/entity.hpp"

namespace rehearse_ros2 {
namespace {

std::int64_t steady_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
std::int64_t system_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// By how much ROS time is ahead of steady time [ns].
std::atomic<std::int64_t>& ros_epoch() {
  static std::atomic<std::int64_t> epoch{system_now() - steady_now()};
  return epoch;
}

}  // namespace

std::int64_t read_clock(rcl_clock_type_t kind) {
  switch (kind) {
    case RCL_SYSTEM_TIME: return system_now();
    case RCL_ROS_TIME: return steady_now() + ros_epoch();
    default: return steady_now();
  }
}

void set_ros_time(std::int64_t nanoseconds) { ros_epoch() = nanoseconds - steady_now(); }

}  // namespace rehearse_ros2

namespace rclcpp {
namespace {

constexpr std::int64_t second = 1'000'000'000;

std::int64_t sum(std::int64_t one, std::int64_t other) {
  std::int64_t result = 0;
  if (!__builtin_add_overflow(one, other, &result)) return result;
  if (other > 0) throw std::overflow_error("addition leads to int64_t overflow");
  throw std::underflow_error("addition leads to int64_t underflow");
}
std::int64_t difference(std::int64_t one, std::int64_t other) {
  std::int64_t result = 0;
  if (!__builtin_sub_overflow(one, other, &result)) return result;
  if (other < 0) throw std::overflow_error("subtraction leads to int64_t overflow");
  throw std::underflow_error("subtraction leads to int64_t underflow");
}

/// Seconds rounded down, and the rest, as 0 <= nanosec.
template <class Message>
Message split(std::int64_t nanoseconds) {
  std::int64_t seconds = nanoseconds / second, rest = nanoseconds % second;
  if (rest < 0) {
    seconds -= 1;
    rest += second;
  }
  Message message;
  message.sec = static_cast<std::int32_t>(seconds);
  message.nanosec = static_cast<std::uint32_t>(rest);
  return message;
}

}  // namespace

Duration::operator builtin_interfaces::msg::Duration() const {
  return split<builtin_interfaces::msg::Duration>(nanoseconds_);
}
Duration Duration::operator+(const Duration& other) const {
  return from_nanoseconds(sum(nanoseconds_, other.nanoseconds_));
}
Duration Duration::operator-(const Duration& other) const {
  return from_nanoseconds(difference(nanoseconds_, other.nanoseconds_));
}
Duration Duration::operator*(double scale) const {
  if (!std::isfinite(scale)) throw std::runtime_error("abnormal scale in rclcpp::Duration");
  const long double product = static_cast<long double>(nanoseconds_) * static_cast<long double>(scale);
  constexpr auto greatest = static_cast<long double>(std::numeric_limits<std::int64_t>::max());
  if (product > greatest) throw std::overflow_error("duration scaling leads to int64_t overflow");
  if (product < -greatest) throw std::underflow_error("duration scaling leads to int64_t underflow");
  return from_nanoseconds(static_cast<std::int64_t>(product));
}
rmw_time_t Duration::to_rmw_time() const {
  if (nanoseconds_ < 0) throw std::runtime_error("rmw_time_t cannot be negative");
  return {static_cast<std::uint64_t>(nanoseconds_ / second), static_cast<std::uint64_t>(nanoseconds_ % second)};
}
Duration Duration::from_seconds(double seconds) {
  return from_nanoseconds(static_cast<std::int64_t>(static_cast<long double>(seconds) * 1e9L));
}
Duration Duration::from_rmw_time(rmw_time_t duration) {
  constexpr auto greatest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (duration.sec > greatest / second - 1) return max();
  return from_nanoseconds(static_cast<std::int64_t>(duration.sec * second + duration.nsec));
}

Time::Time(std::int32_t seconds, std::uint32_t nanoseconds, rcl_clock_type_t kind)
    : nanoseconds_(seconds * second + nanoseconds), kind_(kind) {
  if (seconds < 0) throw std::runtime_error("cannot store a negative time point in rclcpp::Time");
}
Time::operator builtin_interfaces::msg::Time() const { return split<builtin_interfaces::msg::Time>(nanoseconds_); }
Time Time::operator+(const Duration& duration) const { return Time(sum(nanoseconds_, duration.nanoseconds()), kind_); }
Time Time::operator-(const Duration& duration) const {
  return Time(difference(nanoseconds_, duration.nanoseconds()), kind_);
}
Duration Time::operator-(const Time& other) const {
  if (kind_ != other.kind_)
    throw std::runtime_error("can't subtract times with different time sources [" + std::to_string(kind_) +
                             " != " + std::to_string(other.kind_) + "]");
  return Duration::from_nanoseconds(difference(nanoseconds_, other.nanoseconds_));
}
int Time::compared(const Time& other) const {
  if (kind_ != other.kind_) throw std::runtime_error("can't compare times with different time sources");
  return nanoseconds_ < other.nanoseconds_ ? -1 : nanoseconds_ > other.nanoseconds_ ? 1 : 0;
}
builtin_interfaces::msg::Time convert_rcl_time_to_sec_nanos(const rcl_time_point_value_t& nanoseconds) {
  return split<builtin_interfaces::msg::Time>(nanoseconds);
}

bool Clock::sleep_until(Time until, std::shared_ptr<Context> context) {
  if (until.get_clock_type() != kind_) throw std::runtime_error("until's clock type does not match this clock's type");
  return sleep_for(until - now(), std::move(context));
}
bool Clock::sleep_for(Duration duration, std::shared_ptr<Context> context) {
  if (!context) context = contexts::get_global_default_context();
  if (!context->is_valid()) throw std::runtime_error("context cannot be slept with because it's invalid");
  return context->sleep_for(duration.to_chrono<std::chrono::nanoseconds>());
}

Rate::Rate(double frequency, Clock::SharedPtr clock)
    : Rate(frequency > 0.0 ? Duration::from_seconds(1.0 / frequency)
                           : throw std::invalid_argument("rate must be greater than 0"),
           std::move(clock)) {}
Rate::Rate(const Duration& period, Clock::SharedPtr clock)
    : clock_(std::move(clock)), period_(period), last_(clock_->now()) {
  if (period <= Duration(0, 0)) throw std::invalid_argument("period must be greater than 0");
}
bool Rate::sleep() {
  const Time now = clock_->now();
  const Time next = last_ + period_;
  last_ = next;
  if (next <= now) {
    if (now > next + period_) last_ = now + period_;
    return false;
  }
  clock_->sleep_until(next);
  return true;
}

}  // namespace rclcpp
