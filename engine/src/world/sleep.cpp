#include "sleep.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ode_math.h"

namespace rehearse {
namespace {

bool is_connected(const WorldSettings& settings, std::size_t body) {
  return std::ranges::any_of(settings.connections, [body](const Connection& connection) {
    return connection.body == static_cast<int>(body) || connection.other_body == static_cast<int>(body);
  });
}

/// The distance of the farthest corner of the shapes' bounds from the centre of mass [m].
double radius_of(const SimulatedBody& body, dBodyID ode) {
  const Eigen::Vector3d center = vector(dBodyGetPosition(ode));
  double radius = 0.0;
  for (const BodyShape& shape : body.shapes()) {
    dReal bounds[6];
    dGeomGetAABB(shape.geom, bounds);
    Eigen::Vector3d farthest;
    for (int axis = 0; axis < 3; ++axis)
      farthest[axis] =
          std::max(std::abs(bounds[2 * axis] - center[axis]), std::abs(bounds[2 * axis + 1] - center[axis]));
    radius = std::max(radius, farthest.norm());
  }
  return radius;
}

}  // namespace

Sleep::Sleep(const WorldSettings& settings, const std::vector<std::unique_ptr<SimulatedBody>>& bodies) {
  if (!(settings.solver.sleep_after > 0.0)) return;
  steps_ = static_cast<std::int32_t>(std::ceil(std::min(settings.solver.sleep_after / settings.time_step, 1e9)));
  speed_ = settings.solver.sleep_speed;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::vector<MovingPart> parts = bodies[i]->moving_parts();
    const bool is_plain = parts.size() == 1 && !parts[0].joint && !parts[0].plane &&
                          bodies[i]->description().model->devices.empty() && !is_connected(settings, i);
    if (!is_plain) continue;
    indices_.emplace(parts[0].body, sleepers_.size());
    sleepers_.push_back({parts[0].body, *bodies[i], radius_of(*bodies[i], parts[0].body)});
  }
}

std::size_t Sleep::index_of(dBodyID body) const {
  const auto found = indices_.find(body);
  return found == indices_.end() ? none : found->second;
}

std::vector<std::size_t> Sleep::groups_of(const Touches& touches) const {
  std::vector<std::size_t> leader(sleepers_.size());
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](std::size_t sleeper) {
    while (leader[sleeper] != sleeper) sleeper = leader[sleeper] = leader[leader[sleeper]];
    return sleeper;
  };
  for (const Touches::Contact& touch : touches.contacts()) {
    std::size_t a = index_of(touch.a.ode), b = index_of(touch.b.ode);
    if (a == none || b == none) continue;
    a = find(a);
    b = find(b);
    leader[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

/// True for a side whose surface moves, or that a force could move and that can't sleep.
bool Sleep::moves(const Touches::Contact::Side& side) const {
  if (index_of(side.ode) != none) return false;
  return side.yields() || !side.velocity().isZero(0.0);
}

/// The speed of the fastest point of a body, at most [m/s].
double Sleep::speed_of(const Sleeper& sleeper) const {
  return vector(dBodyGetLinearVel(sleeper.body)).norm() +
         sleeper.radius * vector(dBodyGetAngularVel(sleeper.body)).norm();
}

void Sleep::set_asleep(Sleeper& sleeper, bool asleep) {
  sleeper.asleep = asleep ? 1 : 0;
  if (!asleep) {
    sleeper.steps_at_rest = 0;
    dBodyEnable(sleeper.body);
    return;
  }
  dBodySetLinearVel(sleeper.body, 0.0, 0.0, 0.0);
  dBodySetAngularVel(sleeper.body, 0.0, 0.0, 0.0);
  dBodyDisable(sleeper.body);
}

void Sleep::wake(const Touches& touches) {
  if (std::ranges::none_of(sleepers_, [](const Sleeper& sleeper) { return sleeper.asleep != 0; })) return;
  const std::vector<std::size_t> groups = groups_of(touches);
  std::vector<bool> wakes(sleepers_.size(), false);  // by the group's leader
  for (std::size_t i = 0; i < sleepers_.size(); ++i) {
    const dBodyID body = sleepers_[i].body;
    const bool is_moved = !vector(dBodyGetForce(body)).isZero(0.0) || !vector(dBodyGetTorque(body)).isZero(0.0) ||
                          dBodyGetNumJoints(body) > 0 || dBodyIsKinematic(body) || speed_of(sleepers_[i]) > 0.0 ||
                          sleepers_[i].owner.changes_mass();
    if (sleepers_[i].asleep == 0 || is_moved) wakes[groups[i]] = true;
  }
  for (const Touches::Contact& touch : touches.contacts()) {
    const std::size_t a = index_of(touch.a.ode), b = index_of(touch.b.ode);
    if (a != none && moves(touch.b)) wakes[groups[a]] = true;
    if (b != none && moves(touch.a)) wakes[groups[b]] = true;
  }
  for (std::size_t i = 0; i < sleepers_.size(); ++i)
    if (sleepers_[i].asleep != 0 && wakes[groups[i]]) set_asleep(sleepers_[i], false);
}

bool Sleep::is_asleep(const Touches::Contact& contact) const {
  const std::size_t a = index_of(contact.a.ode), b = index_of(contact.b.ode);
  return (a != none && sleepers_[a].asleep != 0) || (b != none && sleepers_[b].asleep != 0);
}

void Sleep::end_step(const Touches& touches) {
  if (sleepers_.empty()) return;
  for (Sleeper& sleeper : sleepers_)
    sleeper.steps_at_rest = speed_of(sleeper) <= speed_ ? std::min(sleeper.steps_at_rest + 1, steps_) : 0;
  if (std::ranges::none_of(
          sleepers_, [this](const Sleeper& sleeper) { return sleeper.asleep == 0 && sleeper.steps_at_rest == steps_; }))
    return;
  const std::vector<std::size_t> groups = groups_of(touches);
  std::vector<bool> stays_awake(sleepers_.size(), false);  // by the group's leader
  std::vector<bool> is_held(sleepers_.size(), false);      // something holds it against gravity
  for (std::size_t i = 0; i < sleepers_.size(); ++i)
    if (sleepers_[i].steps_at_rest < steps_) stays_awake[groups[i]] = true;
  for (const Touches::Contact& touch : touches.contacts()) {
    const std::size_t a = index_of(touch.a.ode), b = index_of(touch.b.ode);
    if (a != none) is_held[groups[a]] = true;
    if (b != none) is_held[groups[b]] = true;
    if (a != none && moves(touch.b)) stays_awake[groups[a]] = true;
    if (b != none && moves(touch.a)) stays_awake[groups[b]] = true;
  }
  for (std::size_t i = 0; i < sleepers_.size(); ++i)
    if (sleepers_[i].asleep == 0 && !stays_awake[groups[i]] && is_held[groups[i]]) set_asleep(sleepers_[i], true);
}

void Sleep::visit_state(StateVisitor& visitor) {
  for (Sleeper& sleeper : sleepers_) {
    visitor.begin_part(sleeper.owner.description().name, sleeper.owner.description().model->links.front().name,
                       StatePart::rest);
    visitor.visit(&sleeper.steps_at_rest, sizeof sleeper.steps_at_rest);
    visitor.visit(&sleeper.asleep, sizeof sleeper.asleep);
  }
}

void Sleep::after_restore() {
  for (Sleeper& sleeper : sleepers_) sleeper.asleep != 0 ? dBodyDisable(sleeper.body) : dBodyEnable(sleeper.body);
}

}  // namespace rehearse
