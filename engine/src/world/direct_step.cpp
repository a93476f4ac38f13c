#include "direct_step.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "contact_rows.h"
#include "ode_joint.h"
#include "ode_math.h"
#include "plane_constraint.h"

namespace rehearse {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Of impulses, as a share of the weight of an island's bodies. Nobody depends on the last digits of the forces between
/// bodies without joints.
constexpr double tolerance = 1e-10, loose_tolerance = 1e-7;
constexpr double standard_gravity = 9.80665;  // [m/s²]

/// The torque of ODE's gyroscopic mode, implicit (C. Lacoursière, Stabilizing Gyroscopic Forces in Rigid Multibody
/// Simulations, 2006): the angular momentum after a step without other torques.
Vector3d turned_momentum(const Matrix3d& inertia, const Vector3d& angular_velocity, double time_step) {
  const Vector3d momentum = inertia * angular_velocity;
  Matrix3d cross;
  cross << 0.0, -momentum.z(), momentum.y(), momentum.z(), 0.0, -momentum.x(), -momentum.y(), momentum.x(), 0.0;
  return inertia * (inertia - time_step * cross).inverse() * momentum;
}

/// Moves a body as ODE does: by its velocity, and by an infinitesimal rotation of its quaternion.
void advance(dBodyID body, double time_step) {
  const Vector3d position = vector(dBodyGetPosition(body)) + time_step * vector(dBodyGetLinearVel(body));
  const Vector3d w = vector(dBodyGetAngularVel(body));
  const dReal* q = dBodyGetQuaternion(body);
  const double half = 0.5 * time_step;
  const dQuaternion next{q[0] + half * (-w.x() * q[1] - w.y() * q[2] - w.z() * q[3]),
                         q[1] + half * (w.x() * q[0] + w.y() * q[3] - w.z() * q[2]),
                         q[2] + half * (-w.x() * q[3] + w.y() * q[0] + w.z() * q[1]),
                         q[3] + half * (w.x() * q[2] - w.y() * q[1] + w.z() * q[0])};
  dBodySetPosition(body, position.x(), position.y(), position.z());
  dBodySetQuaternion(body, next);
}

Vector6d velocity_of(dBodyID body) {
  return body ? spatial(vector(dBodyGetLinearVel(body)), vector(dBodyGetAngularVel(body))) : Vector6d(Vector6d::Zero());
}

}  // namespace

DirectStep::DirectStep(const WorldSettings& settings, double most_velocity,
                       const std::vector<std::unique_ptr<SimulatedBody>>& bodies)
    : law_{settings.time_step, settings.solver.erp / settings.time_step, settings.solver.cfm / settings.time_step},
      most_velocity_(most_velocity),
      surface_layer_(settings.solver.surface_layer),
      erp_(settings.solver.erp),
      gravity_(settings.gravity) {
  std::vector<MovingPart> found;
  for (const auto& body : bodies)
    for (MovingPart& part : body->moving_parts()) found.push_back(part);
  // a tree's parts side by side, in the order of its first part
  std::vector<int> roots(found.size());
  const auto index_in_found = [&](dBodyID body) {
    return static_cast<int>(std::ranges::find_if(found, [&](const MovingPart& p) { return p.body == body; }) -
                            found.begin());
  };
  for (std::size_t i = 0; i < found.size(); ++i)
    roots[i] = found[i].parent ? roots[index_in_found(found[i].parent)] : static_cast<int>(i);
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return roots[a] < roots[b]; });
  for (const std::size_t i : order) {
    const int part = static_cast<int>(parts_.size());
    parts_.push_back(found[i]);
    dBodySetData(found[i].body, reinterpret_cast<void*>(static_cast<std::intptr_t>(part + 1)));
    if (!found[i].parent) trees_.push_back({part, part});
    Tree& tree = trees_.back();
    tree.last = part + 1;
    tree.has_joint |= found[i].joint || found[i].plane;
    tree.is_measured |= found[i].joint && found[i].joint->is_measured();
    trees_of_.push_back(static_cast<int>(trees_.size()) - 1);
    parents_.push_back(part_of(found[i].parent));
  }
  for (const MovingPart& part : parts_) {
    const auto leads = [&](const MovingPart& other) { return part.leader && other.joint == part.leader; };
    const auto leader = std::ranges::find_if(parts_, leads);
    leaders_.push_back(leader == parts_.end() ? -1 : static_cast<int>(leader - parts_.begin()));
  }
  joint_places_.resize(parts_.size());
  motions_.resize(parts_.size());
}

/// -1: nothing moves it, or commands do.
int DirectStep::part_of(dBodyID body) const {
  return body ? static_cast<int>(reinterpret_cast<std::intptr_t>(dBodyGetData(body))) - 1 : -1;
}

int DirectStep::tree_of(dBodyID body) const {
  const int part = part_of(body);
  return part < 0 ? -1 : trees_of_[part];
}

/// -1: the body isn't solved here.
int DirectStep::forest_body(dBodyID body) const {
  const int part = part_of(body);
  if (part < 0) return -1;
  const Tree& tree = trees_[trees_of_[part]];
  return tree.island < 0 ? -1 : part + tree.offset;
}

void DirectStep::begin(const Touches& touches, const Connections& connections) {
  const std::vector<const JointGuide*> guides = connections.guides();
  find_islands(touches, guides);
  contacts_.clear();
  if (island_count_ == 0) return;
  load();
  for (const JointGuide* each : guides)
    if (forest_body(each->first()) >= 0 || forest_body(each->second()) >= 0) add_connection(*each);
}

void DirectStep::find_islands(const Touches& touches, const std::vector<const JointGuide*>& connections) {
  const int count = static_cast<int>(trees_.size());
  std::vector<int> leader(count);
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](int tree) {
    while (leader[tree] != tree) tree = leader[tree] = leader[leader[tree]];
    return tree;
  };
  const auto unite = [&](int a, int b) {
    if (a < 0 || b < 0) return;
    a = find(a);
    b = find(b);
    leader[std::max(a, b)] = std::min(a, b);
  };
  for (const Touches::Contact& touch : touches.contacts()) unite(tree_of(touch.a.ode), tree_of(touch.b.ode));
  for (const JointGuide* each : connections) unite(tree_of(each->first()), tree_of(each->second()));
  for (std::size_t part = 0; part < parts_.size(); ++part)
    if (leaders_[part] >= 0) unite(trees_of_[part], trees_of_[leaders_[part]]);

  std::vector<int> contacts(count, 0);
  std::vector<bool> has_joint(count, false);
  for (int i = 0; i < count; ++i)
    if (trees_[i].has_joint) has_joint[find(i)] = true;
  for (const JointGuide* each : connections)
    for (const dBodyID body : {each->first(), each->second()})
      if (tree_of(body) >= 0) has_joint[find(tree_of(body))] = true;
  for (const Touches::Contact& touch : touches.contacts()) {
    const int tree = std::max(tree_of(touch.a.ode), tree_of(touch.b.ode));
    if (tree >= 0) ++contacts[find(tree)];
  }
  island_count_ = 0;
  leaves_bodies_ = false;
  crowd_ = {};
  have_joints_.clear();
  int bodies = 0;
  std::vector<int> islands(count, -1);
  for (int i = 0; i < count; ++i) {
    Tree& tree = trees_[i];
    const int of = find(i);
    tree.island = -1;
    if (!dBodyIsEnabled(parts_[tree.first].body)) continue;  // it sleeps
    const Crowd crowd{contacts[of], has_joint[of] ? most_contacts : most_loose_contacts};
    if (crowd.contacts > crowd.most) {
      if (crowd.contacts > crowd_.contacts) crowd_ = crowd;
      leaves_bodies_ = true;
      continue;
    }
    if (islands[of] < 0) {
      islands[of] = static_cast<int>(island_count_++);
      have_joints_.push_back(has_joint[of]);
    }
    tree.island = islands[of];
    tree.offset = bodies - tree.first;
    bodies += tree.last - tree.first;
  }
  while (islands_.size() < island_count_) islands_.emplace_back(forest_);
  forest_.bodies().resize(bodies);
}

void DirectStep::load() {
  for (std::size_t i = 0; i < island_count_; ++i) islands_[i].clear();
  for (const Tree& tree : trees_) {
    if (tree.island < 0) continue;
    Island& island = islands_[tree.island];
    for (int part = tree.first; part < tree.last; ++part) {
      load_body(part, forest_.bodies()[part + tree.offset]);
      load_joint(part, island);
      couple(part, island);
    }
    island.add_trees(tree.first + tree.offset, tree.last + tree.offset);
  }
  forest_.arrange();
}

void DirectStep::load_body(int index, TreeBody& body) {
  const MovingPart& part = parts_[index];
  const BodyMotion& motion = motions_[index] = BodyMotion::of(part.body);
  const Matrix3d& axes = motion.rotation;
  const Vector3d& w = motion.angular_velocity;
  body.parent = parents_[index] < 0 ? -1 : parents_[index] + trees_[trees_of_[index]].offset;
  const double mass = part.weight->mass;
  body.mass = mass;
  body.inertia = axes * part.weight->inertia * axes.transpose();
  Vector3d force = vector(dBodyGetForce(part.body));
  if (dBodyGetGravityMode(part.body)) force += mass * gravity_;
  const Vector3d momentum =
      dBodyGetGyroscopicMode(part.body) ? turned_momentum(body.inertia, w, law_.time_step) : Vector3d(body.inertia * w);
  body.momentum = spatial(mass * motion.velocity + law_.time_step * force,
                          momentum + law_.time_step * vector(dBodyGetTorque(part.body)));
  body.gain = body.offset = body.push = 0.0;
  body.drive.reset();
}

void DirectStep::load_joint(int index, Island& island) {
  const MovingPart& part = parts_[index];
  JointPlace& place = joint_places_[index];
  place = {};
  const int at = index + trees_[trees_of_[index]].offset;
  TreeBody& body = forest_.bodies()[at];
  if (dBodyIsKinematic(part.body)) {  // it keeps its velocity, whatever acts on it
    body.joint = {};
    body.joint.bias = spatial(motions_[index].velocity, motions_[index].angular_velocity);
    return;
  }
  if (!part.joint) {
    body.joint = part.plane ? part.plane->motion() : JointMotion::free();
    return;
  }
  static const BodyMotion world;
  part.joint->describe(law_, {motions_[index], parents_[index] < 0 ? world : motions_[parents_[index]]}, body);
  if (std::optional<LimitedDrive> drive = part.joint->limited_drive(law_)) {
    drive->body = at;
    place.drive = island.add_drive(*drive);
  }
  if (std::optional<Stop> stop = part.joint->stops(law_)) {
    stop->body = at;
    place.stop = island.add_stop(*stop);
  }
}

void DirectStep::couple(int index, Island& island) {
  const int leader = leaders_[index];
  if (leader < 0) return;
  JointRow row = parts_[index].joint->coupling(law_, *parts_[index].leader);
  row.body = index + trees_[trees_of_[index]].offset;
  row.other = leader + trees_[trees_of_[leader]].offset;
  joint_places_[index].coupling = island.add_row(row);
}

BoundedRow DirectStep::row_between(const Row& row, dBodyID first, dBodyID second) const {
  BoundedRow bounded;
  bounded.row = row;
  bounded.body = forest_body(first);
  bounded.other = forest_body(second);
  // bodies that aren't solved here keep their velocity
  if (bounded.body < 0) bounded.row.target -= dot6(row.first, velocity_of(first));
  if (bounded.other < 0) bounded.row.target -= dot6(row.second, velocity_of(second));
  if (bounded.body >= 0) return bounded;
  std::swap(bounded.body, bounded.other);
  std::swap(bounded.row.first, bounded.row.second);
  return bounded;
}

void DirectStep::add_connection(const JointGuide& guide) {
  const int tree = std::max(tree_of(guide.first()), tree_of(guide.second()));
  JointGuide::Rows rows;
  const BodyMotion first = BodyMotion::of(guide.first()), second = BodyMotion::of(guide.second());
  guide.add_rows(law_, {first, second}, rows);
  for (const Row& row : rows) islands_[trees_[tree].island].add_row(row_between(row, guide.first(), guide.second()));
}

bool DirectStep::solves(const Touches::Contact& touch) const {
  return forest_body(touch.a.ode) >= 0 || forest_body(touch.b.ode) >= 0;
}

void DirectStep::add(Touches::Contact& touch, const dContact& contact, const Vector3d& estimate) {
  // ODE's first body of a contact; if it is the world, the bodies are swapped
  const dBodyID first = touch.a.ode ? touch.a.ode : touch.b.ode;
  const dBodyID second = touch.a.ode ? touch.b.ode : nullptr;
  const int tree = trees_of_[std::max(part_of(touch.a.ode), part_of(touch.b.ode))];
  const int island_index = trees_[tree].island;
  const ContactRows made =
      contact_rows(contact, first, second, !touch.a.ode, {law_, erp_, surface_layer_, most_velocity_});
  Island& island = islands_[island_index];
  ContactPlace place{&touch, island_index, -1, 0, {}};
  const Vector3d on_first = touch.a.ode ? estimate : Vector3d(-estimate);
  for (std::size_t i = 0; i < made.count; ++i) {
    BoundedRow row = row_between(made.rows[i].row, first, second);
    row.bounds = made.rows[i].bounds;
    if (row.bounds.normal >= 0) row.bounds.normal += place.row;
    if (made.rows[i].is_force) {
      const Vector3d direction = made.rows[i].row.first.head<3>();
      row.impulse = law_.time_step * on_first.dot(direction);
      place.directions[place.count++] = direction;
    }
    const int index = island.add_row(row);
    if (i == 0) place.row = index;
  }
  contacts_.push_back(place);
}

DirectStep::Outcome DirectStep::solve() {
  Outcome outcome;
  outcome.crowd = crowd_;
  std::vector<double> weights(island_count_, 0.0);
  for (const Tree& tree : trees_) {
    if (tree.island < 0) continue;
    for (int part = tree.first; part < tree.last; ++part)
      weights[tree.island] += standard_gravity * law_.time_step * parts_[part].weight->mass;
  }
  for (std::size_t i = 0; i < island_count_; ++i) {
    const BoundedProblem::Outcome solved =
        islands_[i].solve((have_joints_[i] ? tolerance : loose_tolerance) * weights[i]);
    outcome.error = std::max(outcome.error, solved.error / weights[i]);
  }
  for (const Tree& tree : trees_) {
    if (tree.island < 0) continue;
    for (int part = tree.first; part < tree.last; ++part)
      outcome.finite &= forest_.velocity(part + tree.offset).allFinite();
  }
  if (!outcome.finite) return outcome;
  for (const Tree& tree : trees_) {
    if (tree.island < 0) continue;
    finish_joints(tree);
    for (int part = tree.first; part < tree.last; ++part) move(part, islands_[tree.island]);
    turn_to_targets(tree);
  }
  for (const ContactPlace& contact : contacts_) {
    Vector3d force = Vector3d::Zero();
    for (int i = 0; i < contact.count; ++i)
      force += islands_[contact.island].rows()[contact.row + i].impulse / law_.time_step * contact.directions[i];
    std::copy(force.data(), force.data() + 3, contact.touch->feedback.f1);
  }
  return outcome;
}

void DirectStep::finish_joints(const Tree& tree) {
  if (!tree.has_joint) return;
  const Island& island = islands_[tree.island];
  if (tree.is_measured) forest_.find_wrenches(tree.first + tree.offset, tree.last + tree.offset);
  for (int index = tree.first; index < tree.last; ++index) {
    OdeJoint* joint = parts_[index].joint;
    if (!joint) continue;
    const int body = index + tree.offset;
    const JointPlace& place = joint_places_[index];
    double impulse = forest_.bodies()[body].drive ? forest_.drive_impulse(body) : 0.0;
    if (place.drive >= 0) impulse = island.drives()[place.drive].impulse;
    if (place.coupling >= 0) impulse = island.joint_rows()[place.coupling].impulse;
    joint->take_solution({forest_.rate(body), impulse / law_.time_step});
    if (joint->is_measured()) joint->take_wrench(forest_.wrench(body) / law_.time_step);
  }
}

void DirectStep::move(int index, const Island& island) const {
  const dBodyID body = parts_[index].body;
  const int at = index + trees_[trees_of_[index]].offset;
  const auto set = [body](const Vector6d& velocity) {
    dBodySetLinearVel(body, velocity[0], velocity[1], velocity[2]);
    dBodySetAngularVel(body, velocity[3], velocity[4], velocity[5]);
  };
  set(island.moving_velocity(at));
  advance(body, law_.time_step);
  set(forest_.velocity(at));
  dBodySetForce(body, 0.0, 0.0, 0.0);
  dBodySetTorque(body, 0.0, 0.0, 0.0);
}

/// Places links whose joints turn far in the step exactly, and all that they carry with them.
void DirectStep::turn_to_targets(const Tree& tree) const {
  const auto turns_far = [&](const MovingPart& part) { return part.joint && part.joint->turns_far(law_.time_step); };
  if (std::none_of(parts_.begin() + tree.first, parts_.begin() + tree.last, turns_far)) return;
  std::vector<std::optional<Eigen::Isometry3d>> shifts(tree.last - tree.first);  // by part of the tree
  const auto place = [](dBodyID body, const BodyPose& pose) {
    const dQuaternion turn{pose.quaternion.w(), pose.quaternion.x(), pose.quaternion.y(), pose.quaternion.z()};
    dBodySetPosition(body, pose.center.x(), pose.center.y(), pose.center.z());
    dBodySetQuaternion(body, turn);
  };
  for (int part = tree.first; part < tree.last; ++part) {
    if (!parts_[part].joint) continue;
    const dBodyID body = parts_[part].body;
    const BodyPose moved = BodyPose::of(body);
    std::optional<BodyPose> exact = parts_[part].joint->driven_pose(BodyPose::of(parts_[part].parent), law_.time_step);
    const int parent = parents_[part];
    if (!exact && parent >= 0 && shifts[parent - tree.first]) {
      const Eigen::Isometry3d& shift = *shifts[parent - tree.first];
      const Eigen::Quaterniond turn(shift.linear());
      exact = BodyPose{shift * moved.center, shift.linear() * moved.rotation, turn * moved.quaternion};
    }
    if (!exact) continue;
    place(body, *exact);
    Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
    shift.linear() = exact->rotation * moved.rotation.transpose();
    shift.translation() = exact->center - shift.linear() * moved.center;
    shifts[part - tree.first] = shift;
  }
}

void DirectStep::hide_from_ode(bool hidden) const {
  for (const Tree& tree : trees_) {
    if (tree.island < 0) continue;
    for (int part = tree.first; part < tree.last; ++part)
      hidden ? dBodyDisable(parts_[part].body) : dBodyEnable(parts_[part].body);
  }
}

}  // namespace rehearse
