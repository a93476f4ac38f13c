// Quality of service.
#pragma once

#include <cstddef>
#include <string>

#include "rcl/types.h"
#include "rclcpp/time.hpp"

namespace rclcpp {

enum class HistoryPolicy {
  KeepLast = RMW_QOS_POLICY_HISTORY_KEEP_LAST,
  KeepAll = RMW_QOS_POLICY_HISTORY_KEEP_ALL,
  SystemDefault = RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT,
  Unknown = RMW_QOS_POLICY_HISTORY_UNKNOWN
};
enum class ReliabilityPolicy {
  BestEffort = RMW_QOS_POLICY_RELIABILITY_BEST_EFFORT,
  Reliable = RMW_QOS_POLICY_RELIABILITY_RELIABLE,
  SystemDefault = RMW_QOS_POLICY_RELIABILITY_SYSTEM_DEFAULT,
  BestAvailable = RMW_QOS_POLICY_RELIABILITY_BEST_AVAILABLE,
  Unknown = RMW_QOS_POLICY_RELIABILITY_UNKNOWN
};
enum class DurabilityPolicy {
  Volatile = RMW_QOS_POLICY_DURABILITY_VOLATILE,
  TransientLocal = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL,
  SystemDefault = RMW_QOS_POLICY_DURABILITY_SYSTEM_DEFAULT,
  BestAvailable = RMW_QOS_POLICY_DURABILITY_BEST_AVAILABLE,
  Unknown = RMW_QOS_POLICY_DURABILITY_UNKNOWN
};
enum class LivelinessPolicy {
  Automatic = RMW_QOS_POLICY_LIVELINESS_AUTOMATIC,
  ManualByTopic = RMW_QOS_POLICY_LIVELINESS_MANUAL_BY_TOPIC,
  SystemDefault = RMW_QOS_POLICY_LIVELINESS_SYSTEM_DEFAULT,
  BestAvailable = RMW_QOS_POLICY_LIVELINESS_BEST_AVAILABLE,
  Unknown = RMW_QOS_POLICY_LIVELINESS_UNKNOWN
};

struct QoSInitialization {
  rmw_qos_history_policy_t history_policy;
  std::size_t depth;
  QoSInitialization(rmw_qos_history_policy_t history, std::size_t count, bool = false)
      : history_policy(history), depth(count) {}
  static QoSInitialization from_rmw(const rmw_qos_profile_t& profile) { return {profile.history, profile.depth}; }
};
struct KeepAll : QoSInitialization {
  KeepAll() : QoSInitialization(RMW_QOS_POLICY_HISTORY_KEEP_ALL, 0) {}
};
struct KeepLast : QoSInitialization {
  explicit KeepLast(std::size_t count, bool = false) : QoSInitialization(RMW_QOS_POLICY_HISTORY_KEEP_LAST, count) {}
};

class QoS {
 public:
  explicit QoS(const QoSInitialization& initialization, const rmw_qos_profile_t& profile = rmw_qos_profile_default)
      : profile_(profile) {
    profile_.history = initialization.history_policy;
    profile_.depth = initialization.depth;
  }
  QoS(std::size_t depth) : QoS(KeepLast(depth)) {}

  rmw_qos_profile_t& get_rmw_qos_profile() { return profile_; }
  const rmw_qos_profile_t& get_rmw_qos_profile() const { return profile_; }

  QoS& history(HistoryPolicy value) { return history(static_cast<rmw_qos_history_policy_t>(value)); }
  QoS& history(rmw_qos_history_policy_t value) { return set(profile_.history, value); }
  QoS& keep_last(std::size_t count) { return history(HistoryPolicy::KeepLast).set(profile_.depth, count); }
  QoS& keep_all() { return history(HistoryPolicy::KeepAll).set(profile_.depth, std::size_t{0}); }
  QoS& reliability(ReliabilityPolicy value) { return reliability(static_cast<rmw_qos_reliability_policy_t>(value)); }
  QoS& reliability(rmw_qos_reliability_policy_t value) { return set(profile_.reliability, value); }
  QoS& reliable() { return reliability(ReliabilityPolicy::Reliable); }
  QoS& best_effort() { return reliability(ReliabilityPolicy::BestEffort); }
  QoS& reliability_best_available() { return reliability(ReliabilityPolicy::BestAvailable); }
  QoS& durability(DurabilityPolicy value) { return durability(static_cast<rmw_qos_durability_policy_t>(value)); }
  QoS& durability(rmw_qos_durability_policy_t value) { return set(profile_.durability, value); }
  QoS& durability_volatile() { return durability(DurabilityPolicy::Volatile); }
  QoS& transient_local() { return durability(DurabilityPolicy::TransientLocal); }
  QoS& durability_best_available() { return durability(DurabilityPolicy::BestAvailable); }
  QoS& deadline(const Duration& value) { return deadline(value.to_rmw_time()); }
  QoS& deadline(rmw_time_t value) { return set(profile_.deadline, value); }
  QoS& lifespan(const Duration& value) { return lifespan(value.to_rmw_time()); }
  QoS& lifespan(rmw_time_t value) { return set(profile_.lifespan, value); }
  QoS& liveliness(LivelinessPolicy value) { return liveliness(static_cast<rmw_qos_liveliness_policy_t>(value)); }
  QoS& liveliness(rmw_qos_liveliness_policy_t value) { return set(profile_.liveliness, value); }
  QoS& liveliness_lease_duration(const Duration& value) { return liveliness_lease_duration(value.to_rmw_time()); }
  QoS& liveliness_lease_duration(rmw_time_t value) { return set(profile_.liveliness_lease_duration, value); }
  QoS& avoid_ros_namespace_conventions(bool value) { return set(profile_.avoid_ros_namespace_conventions, value); }

  HistoryPolicy history() const { return static_cast<HistoryPolicy>(profile_.history); }
  std::size_t depth() const { return profile_.depth; }
  ReliabilityPolicy reliability() const { return static_cast<ReliabilityPolicy>(profile_.reliability); }
  DurabilityPolicy durability() const { return static_cast<DurabilityPolicy>(profile_.durability); }
  LivelinessPolicy liveliness() const { return static_cast<LivelinessPolicy>(profile_.liveliness); }
  Duration deadline() const { return Duration::from_rmw_time(profile_.deadline); }
  Duration lifespan() const { return Duration::from_rmw_time(profile_.lifespan); }
  Duration liveliness_lease_duration() const { return Duration::from_rmw_time(profile_.liveliness_lease_duration); }
  bool avoid_ros_namespace_conventions() const { return profile_.avoid_ros_namespace_conventions; }

  /// The most messages that wait in a queue.
  std::size_t rehearse_limit() const;

 private:
  template <class Value>
  QoS& set(Value& place, Value value) {
    place = value;
    return *this;
  }
  rmw_qos_profile_t profile_;
};

bool operator==(const QoS& one, const QoS& other);
inline bool operator!=(const QoS& one, const QoS& other) { return !(one == other); }

#define REHEARSE_QOS_CLASS(Name, profile)                                                         \
  class Name : public QoS {                                                                       \
   public:                                                                                        \
    explicit Name(const QoSInitialization& initialization = QoSInitialization::from_rmw(profile)) \
        : QoS(initialization, profile) {}                                                         \
  };
REHEARSE_QOS_CLASS(SensorDataQoS, rmw_qos_profile_sensor_data)
REHEARSE_QOS_CLASS(ParametersQoS, rmw_qos_profile_parameters)
REHEARSE_QOS_CLASS(ServicesQoS, rmw_qos_profile_services_default)
REHEARSE_QOS_CLASS(ParameterEventsQoS, rmw_qos_profile_parameter_events)
REHEARSE_QOS_CLASS(SystemDefaultsQoS, rmw_qos_profile_system_default)
REHEARSE_QOS_CLASS(BestAvailableQoS, rmw_qos_profile_best_available)
#undef REHEARSE_QOS_CLASS
class ClockQoS : public QoS {
 public:
  explicit ClockQoS(const QoSInitialization& initialization = KeepLast(1))
      : QoS(initialization, rmw_qos_profile_sensor_data) {}
};
class RosoutQoS : public QoS {
 public:
  explicit RosoutQoS(const QoSInitialization& initialization = KeepLast(1000)) : QoS(initialization) {
    transient_local();
  }
};

enum class QoSCompatibility { Ok, Warning, Error };
struct QoSCheckCompatibleResult {
  QoSCompatibility compatibility;
  std::string reason;
};
/// Whether messages of a publisher reach a subscription.
QoSCheckCompatibleResult qos_check_compatible(const QoS& publisher, const QoS& subscription);

}  // namespace rclcpp
