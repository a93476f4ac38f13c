#include "contact_rows.h"

#include <algorithm>

#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;

namespace {

/// Contacts yield more than ODE's. With its softness the forces between feet that stiff drives press against each other
/// depend on the last bits of positions: by 0.1 N for a robot of 127 kg. With this one a foot creeps by 2e-7 m/s under
/// a friction of 100 N, and sinks by 6e-9 m under 1 kN.
constexpr double contact_softness = 20.0;  // of a drive's

bool has(const dSurfaceParameters& surface, int mode) { return (surface.mode & mode) == mode; }

/// A force along `direction` at the contact point.
Row force_row(const Vector3d& direction, const Vector3d& arm, const Vector3d& second_arm) {
  Row row;
  row.first = spatial(direction, arm.cross(direction));
  row.second = -spatial(direction, second_arm.cross(direction));
  return row;
}

double rate_of(const Row& row, dBodyID first, dBodyID second) {
  const auto along = [](const Vector6d& direction, dBodyID body) {
    return dot6(direction, spatial(vector(dBodyGetLinearVel(body)), vector(dBodyGetAngularVel(body))));
  };
  return along(row.first, first) + (second ? along(row.second, second) : 0.0);
}

double normal_target(const dContact& contact, double rate, const ContactCorrection& correction) {
  const dSurfaceParameters& surface = contact.surface;
  const double erp = has(surface, dContactSoftERP) ? surface.soft_erp : correction.erp;
  const double depth = std::max(0.0, contact.geom.depth - correction.surface_layer);
  const double separating = std::min(erp / correction.law.time_step * depth, correction.most_velocity);
  if (!has(surface, dContactBounce) || -rate <= surface.bounce_vel) return separating;
  return std::max(separating, surface.bounce * -rate);
}

}  // namespace

ContactRows contact_rows(const dContact& contact, dBodyID first, dBodyID second, bool reversed,
                         const ContactCorrection& correction) {
  const dSurfaceParameters& surface = contact.surface;
  const Vector3d point = vector(contact.geom.pos);
  const Vector3d arm = point - vector(dBodyGetPosition(first));
  const Vector3d second_arm = second ? Vector3d(point - vector(dBodyGetPosition(second))) : Vector3d(Vector3d::Zero());
  const double layer_softness = contact_softness * correction.law.softness, time_step = correction.law.time_step;
  const Vector3d normal = reversed ? Vector3d(-vector(contact.geom.normal)) : vector(contact.geom.normal);

  ContactRows rows;
  const auto add = [&](const Row& row, double softness, double lower, double upper, int of_normal, bool is_force) {
    ContactRow& added = rows.rows[rows.count++];
    added.row = row;
    added.row.softness = softness;
    added.bounds = {lower, upper, of_normal};
    added.is_force = is_force;
  };
  Row push = force_row(normal, arm, second_arm);
  push.target = normal_target(contact, rate_of(push, first, second), correction);
  add(push, has(surface, dContactSoftCFM) ? surface.soft_cfm / time_step : layer_softness, 0.0,
      BoundedProblem::infinite, -1, true);
  const bool rolls = has(surface, dContactRolling), rubs = surface.mu > 0.0;
  if (!rubs && !rolls) return rows;

  Vector3d along, across;
  if (has(surface, dContactFDir1)) {
    along = vector(contact.fdir1);
    across = normal.cross(along);
  } else {
    const dVector3 n{normal.x(), normal.y(), normal.z()};
    dVector3 p, q;
    dPlaneSpace(n, p, q);
    along = vector(p);
    across = vector(q);
  }
  Row friction = force_row(along, arm, second_arm);
  if (has(surface, dContactMotion1)) friction.target = surface.motion1;
  if (rubs)
    add(friction, has(surface, dContactSlip1) ? surface.slip1 / time_step : layer_softness, -surface.mu, surface.mu, 0,
        true);
  const double mu2 = has(surface, dContactMu2) ? surface.mu2 : surface.mu;
  if (rubs && mu2 > 0.0) {
    friction = force_row(across, arm, second_arm);
    if (has(surface, dContactMotion2)) friction.target = surface.motion2;
    add(friction, has(surface, dContactSlip2) ? surface.slip2 / time_step : layer_softness, -mu2, mu2, 0, true);
  }
  if (!rolls) return rows;
  const std::array<double, 3> limits{surface.rho, surface.rho2, surface.rhoN};
  const std::array<Vector3d, 3> axes{along, across, normal};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(limits[i] > 0.0)) continue;
    Row turn;
    turn.first.tail<3>() = axes[i];
    turn.second.tail<3>() = -axes[i];
    add(turn, layer_softness, -limits[i], limits[i], 0, false);
  }
  return rows;
}

}  // namespace rehearse
