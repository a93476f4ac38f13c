#include "rclcpp/qos.hpp"

#include <limits>
#include <tuple>

namespace rclcpp {
namespace {

auto all_of(const rmw_qos_profile_t& profile) {
  const auto time = [](const rmw_time_t& value) { return std::tuple(value.sec, value.nsec); };
  return std::tuple(profile.history, profile.depth, profile.reliability, profile.durability, time(profile.deadline),
                    time(profile.lifespan), profile.liveliness, time(profile.liveliness_lease_duration),
                    profile.avoid_ros_namespace_conventions);
}

}  // namespace

bool operator==(const QoS& one, const QoS& other) {
  return all_of(one.get_rmw_qos_profile()) == all_of(other.get_rmw_qos_profile());
}

std::size_t QoS::rehearse_limit() const {
  constexpr std::size_t default_depth = 10;
  if (history() == HistoryPolicy::KeepAll) return std::numeric_limits<std::size_t>::max();
  return depth() == 0 ? default_depth : depth();
}

QoSCheckCompatibleResult qos_check_compatible(const QoS& publisher, const QoS& subscription) {
  if (publisher.reliability() == ReliabilityPolicy::BestEffort &&
      subscription.reliability() == ReliabilityPolicy::Reliable)
    return {QoSCompatibility::Error, "ERROR: Best effort publisher and reliable subscription;"};
  if (subscription.durability() == DurabilityPolicy::TransientLocal &&
      publisher.durability() != DurabilityPolicy::TransientLocal &&
      publisher.durability() != DurabilityPolicy::BestAvailable)
    return {QoSCompatibility::Error, "ERROR: Volatile publisher and transient local subscription;"};
  return {QoSCompatibility::Ok, ""};
}

}  // namespace rclcpp
