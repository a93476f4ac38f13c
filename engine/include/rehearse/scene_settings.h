// Settings of a scene that belong to no body: how the physics engine solves a step, what connects bodies, and how
// pictures look.
#pragma once

#include <rehearse/model.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// How the physics engine solves a step. The defaults are those of Choreonoid's ODE simulator item.

struct SolverSettings {
  enum class Method {
    quick,  // dWorldQuickStep: iterative, linear in the number of constraints
    exact,  // dWorldStep: direct, cubic
  };
  static constexpr int most_iterations = 10000;
  Method method = Method::quick;
  int iterations = 50;                    // quick only
  bool converge = false;                  // quick only: steps are repeated with more iterations until they converge
  double over_relaxation = 1.3;           // quick only, 0 to 2
  double erp = 0.4;                       // share of a joint's error corrected in a step, 0 to 1
  double cfm = 1e-10;                     // constraint force mixing, >= 0
  double max_correcting_velocity = 0.01;  // of contacts [m/s]
  double surface_layer = 1e-4;            // contacts rest this deep [m]
  double friction = 1.0;                  // coefficient of every contact
  int max_contacts = 100;                 // per pair of shapes
  double belt_depth = unlimited;          // belts don't drive deeper contacts [m]
};

/// The friction and restitution between two materials, in place of those of the surfaces.
struct MaterialPair {
  std::array<std::string, 2> materials;  // ascending; two equal names: the material with itself
  std::optional<double> friction;        // coefficient, in all directions
  std::optional<double> restitution;     // ratio of the speeds after and before a bounce, 0 to 1
};

/// A joint between two links of any bodies, in addition to the models' own. Two links that it connects don't touch each
/// other.
struct Connection {
  std::string name;  // unique; for messages and for matching states
  LoopJoint::Type type = LoopJoint::Type::fixed;
  int body = 0, link = 0;
  int other_body = 0, other_link = 0;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  // of the joint in the first link's frame
  std::optional<Eigen::Isometry3d> other_frame;     // in the other link's frame; nullopt: where it is when they connect
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit vector in the joint's frame
  double from = 0.0;                                // connected while from <= t < until [s]
  double until = unlimited;
};

/// The appearance of a scene apart from its bodies.

/// A lamp of the scene, which belongs to no robot. The direction of its cone is along the world's axes.
struct SceneLight {
  Light light;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
};

struct Look {
  Color sky{0.55f, 0.68f, 0.82f, 1.0f};  // colour of pixels that show no body
  bool shadows = false;                  // for all cameras, whatever they state themselves
  bool antialiasing = false;             // likewise
  std::vector<SceneLight> lights = {};
};

}  // namespace rehearse
