// The rows of a contact in a direct solution. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <array>
#include <cstddef>

#include "joint_guide.h"
#include "solver/bounded_problem.h"

namespace rehearse {

/// How all contacts of a world are corrected.
struct ContactCorrection {
  StepLaw law;
  double erp;            // share of a contact's depth corrected in a step, unless the surface states it
  double surface_layer;  // depth that is left [m]
  double most_velocity;  // of the correction [m/s]
};

struct ContactRow {
  Row row;
  BoundedProblem::Bounds bounds;  // `normal` counts from the contact's first row
  bool is_force = true;           // false: a torque, of rolling friction
};

/// The normal first, then friction along two directions, then rolling friction about them and about the normal.
struct ContactRows {
  std::array<ContactRow, 6> rows;
  std::size_t count = 0;
};

/// The rows of ODE's contact joint between two bodies, of which the second may be the world. `reversed`: the normal
/// points into the second party, since the first is the world.
ContactRows contact_rows(const dContact& contact, dBodyID first, dBodyID second, bool reversed,
                         const ContactCorrection& correction);

}  // namespace rehearse
