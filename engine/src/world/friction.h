// Friction: the directions in which ODE limits the friction of contacts. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/io.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rehearse {

/// Friction at all contact points of two links. Forces act on the pair's first link.
struct FrictionPatch {
  // of the last step; state
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // about the centre of the points [N·m]
  double load = 0.0;                                 // sum of the normal forces [N]
  // of the current step
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();  // angular velocity of the first link relative to the other [rad/s]
  double mass = 0.0;                               // on which friction acts [kg]
  int points = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the points [m]
  double spread = 0.0;                               // sum of the points' squared distances from the centre [m²]
};

/// A contact point.
struct FrictionPoint {
  FrictionPatch* patch;
  Eigen::Vector3d position;  // [m]
  Eigen::Vector3d normal;    // unit
};

/// ODE limits friction along two directions separately, each to mu times the normal force: between them friction
/// reaches 1.41 mu. direct() turns the first direction into that of the slip velocity, or, where nothing slips yet, of
/// the tangential load, which is the opposite of the last step's friction. ODE limits rolling friction about the same
/// two directions: where nothing slips, one of them becomes the axis about which the point rolls.
class Friction {
 public:
  Friction(double time_step, double gravity) : time_step_(time_step), gravity_(gravity) {}

  /// Before ODE's step: the contact points, and the centre and spread of those of each pair of links. The patches are
  /// valid until end().
  void begin();
  FrictionPatch* patch_of(const LinkPair& pair);
  static void add(const Eigen::Vector3d& position, FrictionPatch& patch) {
    ++patch.points;
    patch.center += (position - patch.center) / patch.points;
  }
  static void add_spread(const FrictionPoint& point) {
    point.patch->spread += (point.position - point.patch->center).squaredNorm();
  }
  /// Sets the friction of a contact whose friction is equal in all directions. `velocity`: of the pair's first link
  /// relative to the other before the step [m/s].
  void direct(const FrictionPoint& point, const Eigen::Vector3d& velocity, dContact& contact) const;

  /// The force on the pair's first link at the point, if the last step's forces were spread over the points evenly [N].
  static Eigen::Vector3d last_force(const FrictionPoint& point);

  /// After ODE's step: forgets the last step's forces, and then adds the force of each point [N].
  void end();
  static void add_force(const FrictionPoint& point, const Eigen::Vector3d& force);

  // The state: the patches' forces. Its size depends on the number of pairs that touch.
  void save(std::vector<std::byte>& bytes) const;
  std::size_t saved_size() const;
  /// The patches that save() saved; nullopt if `bytes` can't come from it.
  static std::optional<std::map<LinkPair, FrictionPatch>> read(std::span<const std::byte> bytes);
  const std::map<LinkPair, FrictionPatch>& patches() const { return patches_; }
  void set_patches(std::map<LinkPair, FrictionPatch> patches) { patches_ = std::move(patches); }

 private:
  double time_step_;
  double gravity_;  // [m/s²]
  std::map<LinkPair, FrictionPatch> patches_;
  std::map<LinkPair, FrictionPatch>::iterator place_;  // of the last pair, between begin() and end()
};

}  // namespace rehearse
