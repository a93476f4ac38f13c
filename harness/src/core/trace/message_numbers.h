// The numbers of messages with a fixed set of numbers, in the order of elements_of() of their kind.
#pragma once

#include <rehearse/messages.h>

#include <array>

namespace rehearse {

/// The numbers of a pose or a transform.
template <class Position>
std::array<double, 7> numbers_of(const Position& p, const msg::Quaternion& q) {
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

inline std::array<double, 6> numbers_of(const msg::Vector3& a, const msg::Vector3& b) {
  return {a.x, a.y, a.z, b.x, b.y, b.z};
}

inline auto numbers_of(const msg::PoseStamped& m) { return numbers_of(m.pose.position, m.pose.orientation); }
inline auto numbers_of(const msg::Transform& m) { return numbers_of(m.translation, m.rotation); }
inline auto numbers_of(const msg::TwistStamped& m) { return numbers_of(m.twist.linear, m.twist.angular); }
inline auto numbers_of(const msg::AccelStamped& m) { return numbers_of(m.accel.linear, m.accel.angular); }
inline auto numbers_of(const msg::WrenchStamped& m) { return numbers_of(m.wrench.force, m.wrench.torque); }
inline auto numbers_of(const msg::Imu& m) { return numbers_of(m.angular_velocity, m.linear_acceleration); }

inline std::array<double, 13> numbers_of(const msg::Contact& c) {
  return {c.position.x, c.position.y, c.position.z, c.normal.x,   c.normal.y,   c.normal.z, c.force.x,
          c.force.y,    c.force.z,    c.velocity.x, c.velocity.y, c.velocity.z, c.depth};
}

}  // namespace rehearse
