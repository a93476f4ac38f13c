// Settings of a world and of its appearance: solver, pairs of materials, connections, faults of masses, lamps.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// How a step's forces are solved. The defaults are those of Choreonoid's ODE simulator item, except the method: its
/// quick one leaves errors in the forces of joints, which shake a robot that is held still.
struct SolverSettings {
  enum class Method {
    quick,   // dWorldQuickStep of ODE: iterative, linear in the number of constraints
    exact,   // dWorldStep of ODE: direct, cubic
    direct,  // Rehearse's: direct, linear in the links of robots; quick for islands without joints
  };
  static constexpr std::array<std::string_view, 3> method_names{"quick", "exact", "direct"};  // by Method
  static constexpr int most_iterations = 10000;
  Method method = Method::direct;
  int iterations = 50;                    // quick only
  double over_relaxation = 1.3;           // quick only, 0 to 2
  double erp = 0.4;                       // share of a joint's error corrected in a step, 0 to 1
  double cfm = 1e-10;                     // constraint force mixing, >= 0
  double max_correcting_velocity = 0.01;  // of contacts [m/s]
  double surface_layer = 1e-4;            // contacts rest this deep [m]
  double friction = 1.0;                  // coefficient of every contact
  int max_contacts = 100;                 // per pair of shapes
  double belt_depth = unlimited;          // belts don't drive deeper contacts [m]
  double sleep_after = 0.0;   // bodies without joints and devices that rest so long sleep; 0: they never do [s]
  double sleep_speed = 0.01;  // a body rests while none of its points is faster [m/s]
};

/// The friction and restitution between two materials, in place of those of the surfaces.
struct MaterialPair {
  std::array<std::string, 2> materials;  // ascending; two equal names: the material with itself
  std::optional<double> friction;        // coefficient, in all directions
  std::optional<double> restitution;     // ratio of the speeds after and before a bounce, 0 to 1
};

/// A rigid part of a body has another mass for a time: from <= t < until. Its inertia changes in proportion, its centre
/// of mass stays. All its points keep their velocities when it begins and ends.
struct MassFault {
  int link = 0;                                            // any of the links that fixed joints join to the part
  double factor = 1.0;                                     // of the mass, above 0; factors of several faults multiply
  double from = 0.0;                                       // [s]
  double until = std::numeric_limits<double>::infinity();  // [s]
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

/// What a world is, apart from its bodies.
struct WorldSettings {
  double time_step = 0.001;                     // [s]
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  // [m/s²]
  std::uint32_t seed = 0;
  SolverSettings solver;
  /// Accelerometers and IMUs measure the acceleration at their own place. False: at their link's origin, as in
  /// Choreonoid.
  bool lever_arms = true;
  Eigen::Vector3d magnetic_field = Eigen::Vector3d::Zero();  // the same everywhere, in world axes [T]
  std::vector<MaterialPair> pairs = {};                      // of materials of the bodies
  std::vector<Connection> connections = {};                  // joints and welds between bodies
};

/// A lamp of the scene, which belongs to no robot. The direction of its cone is along the world's axes.
struct SceneLight {
  Light light;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
};

/// The appearance of a scene apart from its bodies.
struct Look {
  Color sky{0.55f, 0.68f, 0.82f, 1.0f};  // colour of pixels that show no body
  bool shadows = false;                  // for all cameras, whatever they state themselves
  bool antialiasing = false;             // likewise
  std::vector<SceneLight> lights = {};
};

}  // namespace rehearse
