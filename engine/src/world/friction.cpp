#include "friction.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace rehearse {

using Eigen::Vector3d;

namespace {

inline Vector3d tangential(const Vector3d& v, const Vector3d& normal) { return v - v.dot(normal) * normal; }

/// A patch as bytes of the state.
struct SavedPatch {
  LinkPair pair;
  double force[3];
  double torque[3];
  double load;
};
static_assert(sizeof(SavedPatch) == 4 * sizeof(int) + 7 * sizeof(double), "no padding gets into the state");

}  // namespace

void Friction::begin() {
  for (auto& [pair, patch] : patches_) {
    patch.points = 0;
    patch.center.setZero();
    patch.spread = 0.0;
  }
  place_ = patches_.begin();
}

/// Searches from the place of the last pair: pairs come nearly in ascending order, and most touched in the last step,
/// too.
FrictionPatch* Friction::patch_of(const LinkPair& pair) {
  if (place_ != patches_.end() && place_->first < pair) ++place_;
  if (place_ == patches_.end() || place_->first != pair) place_ = patches_.try_emplace(pair).first;
  return &place_->second;
}

// Coulomb's law makes the friction force of a slipping point F = -mu N v / |v|. Along v its magnitude is fixed. Across
// v it changes by -mu N / |v| per velocity, which is ODE's force-dependent slip |v| / (mu N). While friction can stop
// the point within the step there is no slip across: the force along the direction then suffices.
void Friction::direct(const FrictionPoint& point, const Vector3d& velocity, dContact& contact) const {
  const FrictionPatch& patch = *point.patch;
  const double available = contact.surface.mu * patch.load / patch.points;  // friction at this point [N]
  const double impulse_mass = patch.mass / patch.points;
  const Vector3d slip = tangential(velocity, point.normal);
  Vector3d friction = patch.force / patch.points;
  if (patch.spread > 0.0) friction += patch.torque.cross(point.position - patch.center) / patch.spread;
  // the load of a new contact is at least the force that stops its approach and carries its weight
  const double approach = std::max(0.0, -velocity.dot(point.normal)) + time_step_ * gravity_;
  const double limit = patch.load > 0.0 ? time_step_ * available : contact.surface.mu * impulse_mass * approach;
  // the impulse that would stop the point within the step
  const Vector3d needed = impulse_mass * slip - time_step_ * tangential(friction, point.normal);
  const double magnitude = needed.norm();
  // ODE's limits exceed mu in every direction, so a smaller impulse is the same whatever the directions are
  constexpr double share_without_direction = 0.5;
  Vector3d direction = needed;
  if (!(magnitude > share_without_direction * limit)) {
    if (!(contact.surface.mode & dContactRolling)) return;
    constexpr double least_spin = 1e-3;  // [rad/s]
    const Vector3d rolling = patch.spin.cross(point.normal);
    if (rolling.norm() > least_spin) {
      direction = rolling;
      contact.surface.rho = std::numeric_limits<double>::min();  // no rolling friction about the direction of rolling
    }
  }
  if (direction.norm() == 0.0) return;
  direction.normalize();
  std::copy(direction.data(), direction.data() + 3, contact.fdir1);
  contact.surface.mode |= dContactFDir1;
  const double stopped = time_step_ * available / impulse_mass;  // slip that friction can stop within the step [m/s]
  if (available <= 0.0 || slip.norm() <= stopped) return;
  contact.surface.mode |= dContactSlip2;
  contact.surface.slip2 = (slip.norm() - stopped) / available;
}

Vector3d Friction::last_force(const FrictionPoint& point) {
  const FrictionPatch& patch = *point.patch;
  return (patch.force + patch.load * point.normal) / patch.points;
}

void Friction::end() {
  std::erase_if(patches_, [](const auto& patch) { return patch.second.points == 0; });
  for (auto& [pair, patch] : patches_) {
    patch.force.setZero();
    patch.torque.setZero();
    patch.load = 0.0;
  }
}

void Friction::add_force(const FrictionPoint& point, const Vector3d& force) {
  FrictionPatch& patch = *point.patch;
  const Vector3d friction = tangential(force, point.normal);
  patch.force += friction;
  patch.torque += (point.position - patch.center).cross(friction);
  patch.load += force.dot(point.normal);
}

std::size_t Friction::saved_size() const { return patches_.size() * sizeof(SavedPatch); }

void Friction::save(std::vector<std::byte>& bytes) const {
  for (const auto& [pair, patch] : patches_) {
    SavedPatch saved{pair, {}, {}, patch.load};
    std::copy(patch.force.data(), patch.force.data() + 3, saved.force);
    std::copy(patch.torque.data(), patch.torque.data() + 3, saved.torque);
    const auto* first = reinterpret_cast<const std::byte*>(&saved);
    bytes.insert(bytes.end(), first, first + sizeof saved);
  }
}

std::optional<std::map<LinkPair, FrictionPatch>> Friction::read(std::span<const std::byte> bytes) {
  if (bytes.size() % sizeof(SavedPatch) != 0) return std::nullopt;
  std::map<LinkPair, FrictionPatch> patches;
  for (; !bytes.empty(); bytes = bytes.subspan(sizeof(SavedPatch))) {
    SavedPatch saved;
    std::memcpy(&saved, bytes.data(), sizeof saved);
    FrictionPatch& patch = patches[saved.pair];
    patch.force = Vector3d(saved.force[0], saved.force[1], saved.force[2]);
    patch.torque = Vector3d(saved.torque[0], saved.torque[1], saved.torque[2]);
    patch.load = saved.load;
  }
  return patches;
}

}  // namespace rehearse
