#include "connections.h"

#include <algorithm>
#include <cstring>

#include "base/digest.h"
#include "ode_math.h"

namespace rehearse {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

std::array<double, 19> motion_of(dBodyID body) {
  std::array<double, 19> motion{};
  double* place = motion.data();
  if (body)
    visit_pose(body, [&](const dReal* numbers, int count) {
      std::memcpy(place, numbers, count * sizeof(double));
      place += count;
    });
  return motion;
}

/// The body's geoms stay where they are.
void set_motion(dBodyID body, const std::array<double, 19>& motion) {
  if (!body) return;
  const double* place = motion.data();
  visit_pose(body, [&](const dReal* numbers, int count) {
    std::memcpy(const_cast<dReal*>(numbers), place, count * sizeof(double));
    place += count;
  });
}

Isometry3d pose_of(const Mount& mount) {
  if (!mount.body) return mount.frame;
  Isometry3d body = Isometry3d::Identity();
  body.linear() = rotation(dBodyGetRotation(mount.body));
  body.translation() = vector(dBodyGetPosition(mount.body));
  return body * mount.frame;
}

}  // namespace

Connections::Connections(dWorldID world, const Bodies& bodies, std::vector<Connection> wanted)
    : world_(world), bodies_(bodies) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const WorldBody& body = bodies[i]->description();
    for (const LoopJoint& loop : body.model->loops) {
      const int index = static_cast<int>(i);
      wanted.push_back({body.name + "/" + loop.name, loop.type, index, loop.link, index, loop.other_link, loop.frame,
                        loop.has_other_frame ? std::optional(loop.other_frame) : std::nullopt, loop.axis});
    }
  }
  for (Connection& each : wanted) slots_.emplace_back().wanted = std::move(each);
  add_holders();
}

void Connections::add_holders() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const WorldBody& body = bodies_[i]->description();
    for (std::size_t device = 0; device < body.model->devices.size(); ++device) {
      const Device& of = body.model->devices[device];
      if (!std::holds_alternative<Holder>(of.kind)) continue;
      Slot& slot = slots_.emplace_back();
      slot.wanted.name = body.name + "/" + of.name;
      slot.wanted.body = static_cast<int>(i);
      slot.wanted.link = of.link;
      slot.wanted.frame = of.pose;
      slot.holder = static_cast<int>(device);
    }
  }
}

Diagnostics Connections::check() const {
  Diagnostics findings;
  for (const Slot& slot : slots_) {
    if (slot.holder >= 0) continue;
    const auto is_nowhere = [&](bool other) {
      const int body = other ? slot.wanted.other_body : slot.wanted.body;
      return bodies_[body]->description().kinematic && !mount(slot, other).body;
    };
    const auto moves = [&](bool other) {
      const dBodyID body = mount(slot, other).body;
      return body && !dBodyIsKinematic(body);
    };
    if (is_nowhere(false) || is_nowhere(true))
      findings.push_back(error("connection '" + slot.wanted.name + "': a link of a kinematic body has no collision " +
                               "shape, so nothing can be connected to it"));
    else if ((!moves(false) && !moves(true)) || mount(slot, false).body == mount(slot, true).body)
      findings.push_back(
          error("connection '" + slot.wanted.name + "' is between links that never move against each " + "other"));
  }
  return findings;
}

Mount Connections::mount(const Slot& slot, bool other) const {
  return other ? bodies_[slot.wanted.other_body]->mount(slot.wanted.other_link)
               : bodies_[slot.wanted.body]->mount(slot.wanted.link);
}

std::string Connections::name_of(int body, int link) const {
  const WorldBody& named = bodies_[body]->description();
  return named.name + "/" + named.model->links[link].name;
}

/// The state has numbers of links that don't depend on the order of bodies and links.
std::uint64_t Connections::number_of(int body, int link) const {
  const std::string name = name_of(body, link);
  return std::max<std::uint64_t>(digest_of(name.data(), name.size()), 1);
}

bool Connections::connect(int body, int link, int other_body, int other_link) const {
  // a link that is fixed to the world belongs to no body of ODE
  const auto part = [this](int of, int at) { return std::pair(bodies_[of]->mount(at).body, of); };
  const auto a = part(body, link), b = part(other_body, other_link);
  return std::ranges::any_of(slots_, [&](const Slot& slot) {
    if (!slot.connected) return false;
    const auto first = part(slot.wanted.body, slot.wanted.link);
    const auto second = part(slot.wanted.other_body, slot.wanted.other_link);
    return (first == a && second == b) || (first == b && second == a);
  });
}

void Connections::update(double time) {
  events_.clear();
  bool changed = false;
  for (Slot& slot : slots_) {
    const Connection& wanted = slot.wanted;
    const bool is_due = wanted.from <= time && time < wanted.until;
    if (slot.holder >= 0 || is_due == slot.connected) continue;
    if (is_due) connect(slot);
    slot.connected = is_due;
    changed = true;
    if (wanted.from > 0.0 || wanted.until != unlimited)
      events_.push_back("'" + wanted.name + "' " + (is_due ? "connects" : "separates") + " '" +
                        name_of(wanted.body, wanted.link) + "' and '" + name_of(wanted.other_body, wanted.other_link) +
                        "'");
  }
  if (changed) make_joints();
}

void Connections::update_holders(const std::vector<LinkPair>& touching) {
  bool changed = false;
  for (Slot& slot : slots_) {
    if (slot.holder < 0) continue;
    const bool before = slot.connected;
    update_holder(slot, touching);
    changed |= slot.connected != before;
  }
  if (changed) make_joints();
}

void Connections::update_holder(Slot& slot, const std::vector<LinkPair>& touching) {
  const bool is_on = bodies_[slot.wanted.body]->is_on(slot.holder);
  if (is_on == slot.connected) return;
  if (is_on && !find_held(slot, touching)) return;
  const std::string held = "'" + name_of(slot.wanted.other_body, slot.wanted.other_link) + "'";
  if (is_on) {
    slot.held = number_of(slot.wanted.other_body, slot.wanted.other_link);
    connect(slot);
  } else {
    slot.connected = false;
    slot.held = 0;
  }
  events_.push_back("holder '" + slot.wanted.name + "' " + (is_on ? "took hold of " : "let go of ") + held);
}

bool Connections::find_held(Slot& slot, const std::vector<LinkPair>& touching) const {
  const Connection& wanted = slot.wanted;
  const Holder& holder = std::get<Holder>(bodies_[wanted.body]->description().model->devices[slot.holder].kind);
  const Vector3d place = (pose_of(mount(slot, false)) * wanted.frame).translation();
  double nearest = unlimited;
  for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
    if (body == wanted.body || bodies_[body]->description().kinematic) continue;
    const int links = static_cast<int>(bodies_[body]->description().model->links.size());
    for (int link = 0; link < links; ++link) {
      const Mount of = bodies_[body]->mount(link);
      if (!of.body) continue;
      double distance = (pose_of(of).translation() - place).norm();
      switch (holder.condition) {
        case Holder::Condition::distance:
          if (distance > holder.max_distance) continue;
          break;
        case Holder::Condition::touch: {
          const LinkPair pair = LinkPair::of(wanted.body, wanted.link, body, link);
          if (!std::binary_search(touching.begin(), touching.end(), pair)) continue;
          break;
        }
        case Holder::Condition::name:
          if (link != 0 || bodies_[body]->description().name != holder.target) continue;
          break;
      }
      if (distance >= nearest) continue;
      nearest = distance;
      slot.wanted.other_body = body;
      slot.wanted.other_link = link;
    }
  }
  return nearest < unlimited;
}

void Connections::connect(Slot& slot) {
  const Mount first = mount(slot, false), second = mount(slot, true);
  const Motion before = motion_of(first.body), other_before = motion_of(second.body);
  close_gap(slot);
  slot.motions = {motion_of(first.body), motion_of(second.body)};
  set_motion(first.body, before);
  set_motion(second.body, other_before);
  slot.connected = true;
}

/// Moves one of the bodies so that both frames of the joint coincide.
void Connections::close_gap(const Slot& slot) const {
  if (!slot.wanted.other_frame) return;
  const Mount first = mount(slot, false), second = mount(slot, true);
  const bool moves_second = second.body != nullptr;
  const Mount& moved = moves_second ? second : first;
  const Isometry3d& own = moves_second ? *slot.wanted.other_frame : slot.wanted.frame;
  const Isometry3d& other = moves_second ? slot.wanted.frame : *slot.wanted.other_frame;
  const Isometry3d pose = pose_of(moves_second ? first : second) * other * (moved.frame * own).inverse();
  const Vector3d place = pose.translation();
  // not by dBodySetPosition, which would move the body's geoms
  Motion motion{};
  std::copy(place.data(), place.data() + 3, motion.data());
  const Eigen::Quaterniond turn(pose.linear());
  const std::array<double, 4> quaternion{turn.w(), turn.x(), turn.y(), turn.z()};
  std::copy(quaternion.begin(), quaternion.end(), motion.data() + 3);
  std::memcpy(motion.data() + 7, OdeRotation(pose.linear()).r, 12 * sizeof(double));
  set_motion(moved.body, motion);
}

/// The order of a body's joints determines that of the solver's rows. So when a joint is added or removed, all joints
/// are made anew, in their order: it is then a function of the state.
void Connections::make_joints() {
  for (Slot& slot : slots_) {
    if (slot.joint) dJointDestroy(slot.joint);
    slot.joint = nullptr;
  }
  for (Slot& slot : slots_)
    if (slot.connected) make_joint(slot);
}

void Connections::make_joint(Slot& slot) {
  const Mount first = mount(slot, false), second = mount(slot, true);
  const Motion before = motion_of(first.body), other_before = motion_of(second.body);
  set_motion(first.body, slot.motions[0]);
  set_motion(second.body, slot.motions[1]);
  const Isometry3d frame = pose_of(first) * slot.wanted.frame;
  const Vector3d anchor = frame.translation(), axis = frame.linear() * slot.wanted.axis;
  const bool swapped = first.body == nullptr;
  slot.guide.emplace(slot.wanted.type, swapped ? second.body : first.body, swapped ? nullptr : second.body, anchor,
                     axis);
  switch (slot.wanted.type) {
    case LoopJoint::Type::fixed:
      slot.joint = dJointCreateFixed(world_, nullptr);
      dJointAttach(slot.joint, first.body, second.body);
      dJointSetFixed(slot.joint);
      break;
    case LoopJoint::Type::revolute:
      slot.joint = dJointCreateHinge(world_, nullptr);
      dJointAttach(slot.joint, first.body, second.body);
      dJointSetHingeAnchor(slot.joint, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(slot.joint, axis.x(), axis.y(), axis.z());
      break;
    case LoopJoint::Type::prismatic:
      slot.joint = dJointCreateSlider(world_, nullptr);
      dJointAttach(slot.joint, first.body, second.body);
      dJointSetSliderAxis(slot.joint, axis.x(), axis.y(), axis.z());
      break;
    case LoopJoint::Type::spherical:
      slot.joint = dJointCreateBall(world_, nullptr);
      dJointAttach(slot.joint, first.body, second.body);
      dJointSetBallAnchor(slot.joint, anchor.x(), anchor.y(), anchor.z());
      break;
  }
  set_motion(first.body, before);
  set_motion(second.body, other_before);
}

std::vector<const JointGuide*> Connections::guides() const {
  std::vector<const JointGuide*> guides;
  for (const Slot& slot : slots_)
    if (slot.joint) guides.push_back(&*slot.guide);
  return guides;
}

void Connections::visit_state(StateVisitor& visitor) {
  for (Slot& slot : slots_) {
    visitor.begin_part("", slot.wanted.name, StatePart::connection);
    double connected = slot.connected ? 1.0 : 0.0;
    visitor.visit(connected);
    slot.connected = connected != 0.0;
    visitor.visit(&slot.held, sizeof slot.held);
    for (Motion& motion : slot.motions) visitor.visit(motion.data(), sizeof motion);
  }
}

void Connections::after_restore() {
  events_.clear();
  for (Slot& slot : slots_) {
    if (slot.holder < 0 || !slot.connected) continue;
    slot.connected = false;
    for (int body = 0; body < static_cast<int>(bodies_.size()); ++body) {
      const int links = static_cast<int>(bodies_[body]->description().model->links.size());
      for (int link = 0; link < links && !slot.connected; ++link) {
        if (number_of(body, link) != slot.held) continue;
        slot.wanted.other_body = body;
        slot.wanted.other_link = link;
        slot.connected = true;
      }
    }
  }
  make_joints();
}

}  // namespace rehearse
