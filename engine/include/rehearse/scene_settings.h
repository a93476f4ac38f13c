// Settings of a scene that belong to no body: how the physics engine solves a step, and how pictures look.
#pragma once

#include <rehearse/model.h>

#include <array>
#include <optional>
#include <string>

namespace rehearse {

/// How the physics engine solves a step. The defaults are those of Choreonoid's ODE simulator item.

struct SolverSettings {
  enum class Method {
    quick,  // dWorldQuickStep: iterative, linear in the number of constraints
    exact,  // dWorldStep: direct, cubic
  };
  Method method = Method::quick;
  int iterations = 50;                    // quick only
  double over_relaxation = 1.3;           // quick only, 0 to 2
  double erp = 0.4;                       // share of a joint's error corrected in a step, 0 to 1
  double cfm = 1e-10;                     // constraint force mixing, >= 0
  double max_correcting_velocity = 0.01;  // of contacts [m/s]
  double surface_layer = 1e-4;            // contacts rest this deep [m]
  double friction = 1.0;                  // coefficient of every contact
  int max_contacts = 100;                 // per pair of shapes
};

/// The friction and restitution between two materials, in place of those of the surfaces.
struct MaterialPair {
  std::array<std::string, 2> materials;  // ascending; two equal names: the material with itself
  std::optional<double> friction;        // coefficient, in all directions
  std::optional<double> restitution;     // ratio of the speeds after and before a bounce, 0 to 1
};

/// The appearance of a scene apart from its bodies.

struct Look {
  Color sky{0.55f, 0.68f, 0.82f, 1.0f};  // colour of pixels that show no body
};

}  // namespace rehearse
