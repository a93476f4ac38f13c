// The numbers of messages that always have the same, in the order of elements_of() of their kind.
#pragma once

#include <rehearse/messages.h>

#include <array>

namespace rehearse {

inline std::array<double, 7> numbers_of(const msg::PoseStamped& m) {
  const auto& [p, q] = m.pose;
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

inline std::array<double, 6> numbers_of(const msg::Vector3& a, const msg::Vector3& b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

inline auto numbers_of(const msg::TwistStamped& m) { return numbers_of(m.twist.linear, m.twist.angular); }
inline auto numbers_of(const msg::AccelStamped& m) { return numbers_of(m.accel.linear, m.accel.angular); }
inline auto numbers_of(const msg::WrenchStamped& m) { return numbers_of(m.wrench.force, m.wrench.torque); }
inline auto numbers_of(const msg::Imu& m) { return numbers_of(m.angular_velocity, m.linear_acceleration); }

}  // namespace rehearse
