// A buffer of transforms, on tf2 of the workspace. It doesn't wait for transforms: who asks too early gets tf2's
// exception.
#pragma once

#include <tf2/buffer_core.h>
#include <tf2/convert.h>
#include <tf2/time.h>

#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>

namespace tf2_ros {

inline tf2::TimePoint fromRclcpp(const rclcpp::Time& time) {
  return tf2::TimePoint(std::chrono::nanoseconds(time.nanoseconds()));
}
inline tf2::Duration fromRclcpp(const rclcpp::Duration& duration) {
  return std::chrono::nanoseconds(duration.nanoseconds());
}
inline rclcpp::Time toRclcpp(const tf2::TimePoint& time) {
  return rclcpp::Time(std::chrono::nanoseconds(time.time_since_epoch()).count());
}
inline rclcpp::Duration toRclcpp(const tf2::Duration& duration) { return rclcpp::Duration(duration); }
inline tf2::TimePoint fromMsg(const builtin_interfaces::msg::Time& time) { return fromRclcpp(rclcpp::Time(time)); }
inline tf2::Duration fromMsg(const builtin_interfaces::msg::Duration& duration) {
  return fromRclcpp(rclcpp::Duration(duration));
}
inline builtin_interfaces::msg::Time toMsg(const tf2::TimePoint& time) { return toRclcpp(time); }
inline builtin_interfaces::msg::Duration toMsg(const tf2::Duration& duration) { return toRclcpp(duration); }
inline double timeToSec(const builtin_interfaces::msg::Time& time) { return rclcpp::Time(time).seconds(); }

class Buffer : public tf2::BufferCore {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Buffer)
  template <class NodeType = rclcpp::Node::SharedPtr>
  explicit Buffer(rclcpp::Clock::SharedPtr clock, tf2::Duration cache = tf2::BUFFER_CORE_DEFAULT_CACHE_TIME,
                  NodeType = NodeType(), const rclcpp::QoS& = rclcpp::ServicesQoS())
      : tf2::BufferCore(cache), clock_(std::move(clock)) {}
  using tf2::BufferCore::canTransform;
  using tf2::BufferCore::lookupTransform;
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target, const std::string& source,
                                                       const rclcpp::Time& time,
                                                       const rclcpp::Duration& = rclcpp::Duration(0, 0)) const {
    return tf2::BufferCore::lookupTransform(target, source, fromRclcpp(time));
  }
  geometry_msgs::msg::TransformStamped lookupTransform(const std::string& target, const std::string& source,
                                                       const tf2::TimePoint& time, const tf2::Duration) const {
    return tf2::BufferCore::lookupTransform(target, source, time);
  }
  bool canTransform(const std::string& target, const std::string& source, const rclcpp::Time& time,
                    const rclcpp::Duration& = rclcpp::Duration(0, 0), std::string* problem = nullptr) const {
    return tf2::BufferCore::canTransform(target, source, fromRclcpp(time), problem);
  }
  bool canTransform(const std::string& target, const std::string& source, const tf2::TimePoint& time,
                    const tf2::Duration, std::string* problem = nullptr) const {
    return tf2::BufferCore::canTransform(target, source, time, problem);
  }
  template <class Value>
  Value& transform(const Value& in, Value& out, const std::string& target, tf2::Duration = tf2::Duration(0)) const {
    tf2::doTransform(in, out, lookupTransform(target, tf2::getFrameId(in), tf2::getTimestamp(in)));
    return out;
  }
  template <class Value>
  Value transform(const Value& in, const std::string& target, tf2::Duration timeout = tf2::Duration(0)) const {
    Value out;
    return transform(in, out, target, timeout);
  }
  rclcpp::Clock::SharedPtr getClock() { return clock_; }
  template <class TimerInterface>
  void setCreateTimerInterface(TimerInterface) {}

 private:
  rclcpp::Clock::SharedPtr clock_;
};

class CreateTimerROS {
 public:
  template <class... Arguments>
  explicit CreateTimerROS(Arguments&&...) {}
};

}  // namespace tf2_ros
