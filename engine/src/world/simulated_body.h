// SimulatedBody: interface of one WorldBody in the world's loop. Private to the world library.
//
// A step is before_step(), drive(), add_wrench() as often as wanted, contacts, ODE's step, after_step(). OdeBody moves
// by its dynamics, KinematicBody as commanded.
#pragma once

#include <ode/ode.h>
#include <rehearse/io.h>
#include <rehearse/world.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "polytope.h"

namespace rehearse {

/// The parts of the state that an owner (world, link, joint or device) can have.
enum class StatePart {
  clock,          // of the world: ticks and random numbers
  motion,         // of a rigid group, by its first link, or of a kinematic link
  displacement,   // of a joint
  effort,         // of a joint
  acceleration,   // of a joint
  gear,           // of a joint with backlash: its rotor within the gap
  commands,       // of a joint with an actuator: those under way
  lock,           // of a joint whose actuator has faults: where it is locked
  heat,           // of a joint whose actuator gets hot
  belt,           // of a track
  wrench,         // measured by a force sensor in the last step; the next step doesn't depend on it
  acting_device,  // of a rotor or holder: its command
  connection,     // of a joint between bodies, or of a holder
  contact,        // measured by a contact sensor in the last step; the next step doesn't depend on it
  rest,           // of a body that can sleep: its steps at rest
};

/// Numbers of a state that lie side by side.
template <std::size_t count>
struct Piece {
  explicit Piece(const double* first) : numbers(const_cast<double*>(first)) {}
  static constexpr std::size_t size = count * sizeof(double);  // [bytes]
  double* numbers;
};

/// Reads or writes pieces of state. A state has hundreds of pieces and is read in each tick: a visitor that only copies
/// them gives its memory, and is called when that is full.
class StateVisitor {
 public:
  virtual ~StateVisitor() = default;
  /// Begins a part: the visits until the next call belong to it. `body` and `owner` are names; `owner` is a link, joint
  /// or device of the body. A part has the same name and size in every world that has that owner.
  void begin_part(const std::string& body, const std::string& owner, StatePart part) {
    if (!memory_) enter(body, owner, part);
  }
  void visit(void* data, std::size_t size) {
    if (size > free_) return take(data, size);
    std::memcpy(memory_, data, size);
    memory_ += size;
    free_ -= size;
  }
  /// One after the other.
  template <std::size_t... counts>
  void visit(Piece<counts>... pieces) {
    constexpr std::size_t size = (Piece<counts>::size + ...);
    if (size > free_) return (visit(pieces.numbers, pieces.size), ...);
    std::byte* place = memory_;
    ((std::memcpy(place, pieces.numbers, pieces.size), place += pieces.size), ...);
    memory_ = place;
    free_ -= size;
  }
  void visit(double& number) { visit(&number, sizeof number); }
  void visit(Eigen::Vector3d& numbers) { visit(numbers.data(), 3 * sizeof(double)); }
  void visit(Eigen::Quaterniond& numbers) { visit(numbers.coeffs().data(), 4 * sizeof(double)); }

 protected:
  /// Called only without memory.
  virtual void enter(const std::string& body, const std::string& owner, StatePart part) = 0;
  /// Called for pieces that are larger than the free memory.
  virtual void take(void* data, std::size_t size) = 0;
  /// From now on pieces are copied to this memory, and parts are not entered.
  void copy_to(std::span<std::byte> memory) {
    memory_ = memory.data();
    free_ = memory.size();
  }
  std::size_t free() const { return free_; }  // [bytes]

 private:
  std::byte* memory_ = nullptr;  // the free part of it; null: none
  std::size_t free_ = 0;         // [bytes]
};

/// The motion of a track's surface in the coming step.
struct Belt {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit vector, world
  double speed = 0.0;                               // of the surface [m/s], positive as of a wheel about the axis

  /// The direction in which the surface runs at a point with this normal: axis x normal, unit length. Zero on a flank,
  /// where there is no direction.
  Eigen::Vector3d along(const Eigen::Vector3d& normal) const;
};

/// A collision shape, or one hull of its mesh. Its geom belongs to the body.
struct BodyShape {
  dGeomID geom = nullptr;
  int link = 0;                                // index into the model's links
  int belt = -1;                               // index for SimulatedBody::belt(); -1: its surface doesn't run
  int collision = 0;                           // index into the link's collisions
  std::shared_ptr<const Polytope> polytope;    // of boxes and hulls, in the geom's frame; null for other shapes
  std::shared_ptr<const void> kept;            // data that ODE points to
  std::shared_ptr<const Heightmap> heightmap;  // null for all shapes but ground
};

/// A contact of the last step from the side of one of its two links.
struct Touch {
  int link = 0;       // index into the model's links
  int collision = 0;  // index into the link's collisions
  ContactReading reading;
};

/// The body of ODE to which a link is fixed, and the link's place in it.
struct Mount {
  dBodyID body = nullptr;                                   // null: the link never moves
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  // of the link in the body's frame, or in the world
};

class OdeJoint;
class PlaneConstraint;

/// Of a rigid body. A fault may change it before a step.
struct RigidMass {
  double mass = 0.0;                                  // [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, along its own axes [kg·m²]
};

/// A rigid body that forces move, with the joint that connects it to its parent.
struct MovingPart {
  dBodyID body = nullptr;
  dBodyID parent = nullptr;  // null: the joint's other side is the world, or there is no joint
  const RigidMass* weight = nullptr;
  OdeJoint* joint = nullptr;               // null: none
  const OdeJoint* leader = nullptr;        // that the joint follows; null: none
  const PlaneConstraint* plane = nullptr;  // null: none
};

/// The errors of a step at a body's joints, as in Residual; links are indices into the model's, -1: none.
struct JointErrors {
  int link = -1;
  double share = 0.0;  // of the body's weight
  int missed = -1;
  double velocity = 0.0;  // [rad/s] or [m/s]
};

class SimulatedBody {
 public:
  explicit SimulatedBody(WorldBody description);
  virtual ~SimulatedBody();
  SimulatedBody(const SimulatedBody&) = delete;
  SimulatedBody& operator=(const SimulatedBody&) = delete;

  /// Takes the masses of the step, which begins at `time` [s], and stores the current velocities, to compute
  /// accelerations after the step.
  virtual void before_step(double time) = 0;
  /// True if a mass in the coming step isn't that of the step before.
  virtual bool changes_mass() const { return false; }
  /// Adds forces and sets motors, or motions, for the coming step.
  virtual void drive(const BodyCommand& command) = 0;
  virtual void add_wrench(int link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque_about_origin) = 0;
  virtual Eigen::Vector3d link_point(int link, const Eigen::Vector3d& point_in_link) const = 0;
  virtual Belt belt(int index) const = 0;
  /// A kinematic body's link without shapes has no body of ODE, although it moves.
  virtual Mount mount(int link) const = 0;
  /// Of the last step.
  virtual JointErrors residual() const { return {}; }
  /// Reads the results of the step. Call take_touches() before it.
  virtual void after_step() = 0;
  /// Fills the readings from the state.
  virtual void observe(BodyObservation& observation, const WorldSettings& settings, bool stepped) const = 0;
  /// False if the simulation has exploded: a number isn't finite, or a rigid body is faster than most_velocity.
  virtual bool plausible() const = 0;
  static constexpr double most_velocity = 1e8;  // [m/s] or [rad/s]

  /// ODE's bodies, which exist as long as this.
  virtual std::vector<dBodyID> ode_bodies() const = 0;
  /// Its rigid bodies that forces move, parents before their children; they exist as long as this.
  virtual std::vector<MovingPart> moving_parts() { return {}; }

  /// Passes every piece of state to the visitor, in a fixed order. This function alone defines the state. The visitor
  /// may read or write. After writing, call after_restore().
  virtual void visit_state(StateVisitor& visitor) = 0;
  virtual void after_restore() = 0;
  /// Call it after the state was taken part by part from `other`, whose links may have different centres of mass, and
  /// before after_restore(). Moves the links to the poses of the other's links.
  virtual void take_centers(const SimulatedBody& other) = 0;
  /// Changes the last bit of the positions of its rigid bodies, up or down depending on `bits`.
  virtual void nudge(std::uint64_t bits) = 0;

  const WorldBody& description() const { return description_; }
  double mass() const { return mass_ + added_mass_; }  // of all links [kg]
  /// In link order, shapes in their link's order.
  const std::vector<BodyShape>& shapes() const { return shapes_; }
  /// Pairs of shapes, by index, that may touch each other; ascending.
  const std::vector<std::pair<std::size_t, std::size_t>>& own_pairs() const { return own_pairs_; }
  /// Warnings about behaviour that the body's author may not expect.
  const Diagnostics& remarks() const { return remarks_; }
  /// From now on observe() reports the contacts of the link.
  void watch(int link);
  /// Commands a rotor or a holder; `values` is its whole state as cnoid's writeState() gives it.
  void command(int device, const std::vector<double>& values);
  /// True if that holder is turned on.
  bool is_on(int device) const { return !acting_devices_.empty() && acting_devices_[device].on != 0.0; }
  /// True if contacts of the link are needed (it is watched, or a sensor measures them): pass them to take_touches().
  bool feels(int link) const { return feels_[link]; }
  /// True if contacts of any link are needed.
  bool feels() const { return feels_something_; }
  /// Sets the contacts of the last step of the links for which feels() is true, in the order in which they were found.
  void take_touches(std::vector<Touch> touches);
  /// Removes the contacts of the last step, because the state was replaced.
  void forget_touches() { touches_.clear(); }
  /// True if the links never move against each other.
  bool move_together(int link, int other) const { return groups_[link] == groups_[other]; }

 protected:
  /// That faults add to the model's [kg].
  void add_mass(double mass) { added_mass_ = mass; }
  double added_mass() const { return added_mass_; }
  const Model& model() const { return *description_.model; }  // its joints as their actuators make them
  const std::string& name() const { return description_.name; }
  struct AddedGeom {
    dGeomID geom;
    Eigen::Isometry3d in_link;
  };
  /// Makes the geoms of a collision shape, to be placed by the caller.
  std::vector<AddedGeom> add_shape(int link, int collision, int belt = -1);
  /// Sets own_pairs(). All joints must be at zero.
  void pair_own_shapes();
  void feel(int link);
  const std::vector<Touch>& touches() const { return touches_; }
  /// Fills the readings of sensors with values, from the links in the observation and the contacts of the last step.
  void observe_devices(BodyObservation& observation, const WorldSettings& settings, bool stepped) const;
  /// Visits the state of contact sensors; the last part of visit_state().
  void visit_contact_sensors(StateVisitor& visitor);
  /// Passes the state of rotors and holders to the visitor.
  void visit_acting_devices(StateVisitor& visitor);
  /// Adds the forces of the rotors for the coming step.
  void apply_rotors();

 private:
  /// Sets force, then torque, of a force sensor by device index.
  virtual void read_force(std::size_t device, std::vector<double>& values) const = 0;

  /// The measurement of a contact sensor in the last step, in world axes, like the measurements of other sensors; it is
  /// turned into the device frame later.
  struct ContactSum {
    double points = 0.0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the link [N]
  };
  /// The command to a rotor or holder. Position and direction are in the link frame.
  struct ActingDevice {
    double on = 0.0;                                      // 1: it is on
    Eigen::Vector3d position = Eigen::Vector3d::Zero();   // [m]
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit length
    double thrust = 0.0;                                  // along the direction [N]
    double torque = 0.0;                                  // about it [N·m]
  };
  void read_contact(std::size_t device, const LinkReading& link, double time_step, std::vector<double>& values) const;

  WorldBody description_;
  double mass_;
  double added_mass_ = 0.0;
  std::vector<int> groups_;  // by link index: its rigid group
  std::vector<BodyShape> shapes_;
  std::vector<std::pair<std::size_t, std::size_t>> own_pairs_;
  Diagnostics remarks_;
  std::vector<bool> feels_;    // by link index
  std::vector<bool> watched_;  // by link index; empty: no link is watched
  bool feels_something_ = false;
  std::vector<Touch> touches_;
  std::vector<ContactSum> contact_sums_;      // by device index; state of the contact sensors
  std::vector<ActingDevice> acting_devices_;  // by device index; empty: the body has neither rotors nor holders
};

/// Checks everything on which ODE would abort. The messages begin with "body 'SR1': ".
Diagnostics check_dynamics(const WorldBody& description);

/// Errors about joints that ODE's own solvers can't move: those that follow others.
Diagnostics check_mimics(const WorldBody& description);

/// True if the root link never moves: the scenario or the model fixes it.
bool root_is_fixed(const WorldBody& description);

}  // namespace rehearse
