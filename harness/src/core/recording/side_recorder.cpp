#include "side_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "vector_messages.h"

namespace rehearse {
namespace {

constexpr std::pair<Quantity, std::vector<double> msg::JointState::*> joint_arrays[] = {
    {Quantity::q, &msg::JointState::position},
    {Quantity::dq, &msg::JointState::velocity},
    {Quantity::u, &msg::JointState::effort}};

}  // namespace

mcap::StringMap joint_metadata(ChannelKind kind, const Model& model, const std::vector<int>& joints) {
  mcap::StringMap metadata;
  for (const int id : joints) {
    const Joint& joint = model.links[model.joints[id]].joint;
    for (const ElementGroup& group : form_of(kind).groups)
      metadata[fmt::format("unit:{}/{}", joint.name, group.name)] = unit_of_joint(group.name, is_linear(joint.type));
  }
  return metadata;
}

SideRecorder::SideRecorder(TraceOutput& output, const std::string& label, ChannelSide side, const Model& model,
                           const IoLayout& layout, mcap::StringMap metadata)
    : metadata_(std::move(metadata)) {
  const ChannelName of_side = ChannelName::of_controller(label, side, ChannelKind::joints);
  add_joints(output, of_side, model, layout);
  for (const IoField& field : layout.fields)
    if (field.quantity > Quantity::u) add_link(output, of_side, model, field);
}

void SideRecorder::add_joints(TraceOutput& output, const ChannelName& of_side, const Model& model,
                              const IoLayout& layout) {
  std::vector<int> joints;  // in link order, each once
  std::set<Quantity> used;
  for (const IoField& field : layout.fields) {
    if (field.quantity > Quantity::u) continue;
    if (joints.empty() || joints.back() != field.joint) joints.push_back(field.joint);
    used.insert(field.quantity);
    const std::size_t index = joints.size() - 1;
    acceleration_offsets_.resize(joints.size(), -1);
    if (field.quantity == Quantity::ddq) acceleration_offsets_[index] = field.offset;
    for (const auto& [quantity, array] : joint_arrays)
      if (quantity == field.quantity) slots_.push_back({field.offset, array, index});
  }
  for (const int joint : joints) joint_message_.name.push_back(model.links[model.joints[joint]].joint.name);
  const double not_enabled = std::nan("");
  for (const auto& [quantity, array] : joint_arrays)
    if (used.contains(quantity)) (joint_message_.*array).assign(joints.size(), not_enabled);
  if (used.contains(Quantity::ddq)) {
    ChannelName name = of_side;
    name.kind = ChannelKind::joint_accelerations;
    acceleration_message_.name = joint_message_.name;
    acceleration_message_.acceleration.assign(joints.size(), not_enabled);
    accelerations_ = output.channel<msg::JointAccelerations>(name, joint_metadata(name.kind, model, joints));
  }
  if (slots_.empty()) return;
  mcap::StringMap metadata = joint_metadata(of_side.kind, model, joints);
  metadata.insert(metadata_.begin(), metadata_.end());
  joints_ = output.channel<msg::JointState>(of_side, std::move(metadata));
}

void SideRecorder::add_link(TraceOutput& output, ChannelName name, const Model& model, const IoField& field) {
  name.kind = channel_kind_of(field.quantity);
  name.owner = model.links[field.link].name;
  std::uint16_t id = 0;
  switch (field.quantity) {
    case Quantity::pose: id = output.channel<msg::PoseStamped>(name, metadata_); break;
    case Quantity::twist: id = output.channel<msg::TwistStamped>(name, metadata_); break;
    case Quantity::acceleration: id = output.channel<msg::AccelStamped>(name, metadata_); break;
    default: id = output.channel<msg::WrenchStamped>(name, metadata_); break;
  }
  links_.push_back({id, field});
}

Result<void> SideRecorder::write(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) {
  if (auto done = write_joints(output, tick, values); !done) return done;
  const msg::Header header{output.stamp(tick), "world"};
  for (const LinkChannel& link : links_) {
    const double* v = values.data() + link.field.offset;
    const auto write = [&](const auto& message) { return output.write(link.channel, tick, message); };
    const Result<void> done = [&] {
      switch (link.field.quantity) {
        case Quantity::pose: return write(msg::PoseStamped{header, {point(v), quaternion(v + 3)}});
        case Quantity::twist: return write(msg::TwistStamped{header, {vector3(v), vector3(v + 3)}});
        case Quantity::acceleration: return write(msg::AccelStamped{header, {vector3(v), vector3(v + 3)}});
        default: return write(msg::WrenchStamped{header, {vector3(v), vector3(v + 3)}});
      }
    }();
    if (!done) return done;
  }
  return {};
}

Result<void> SideRecorder::write_joints(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) {
  if (joints_) {
    joint_message_.header.stamp = output.stamp(tick);
    for (const Slot& slot : slots_) (joint_message_.*slot.array)[slot.index] = values[slot.offset];
    if (auto done = output.write(joints_, tick, joint_message_); !done) return done;
  }
  if (!accelerations_) return {};
  acceleration_message_.header.stamp = output.stamp(tick);
  for (std::size_t i = 0; i < acceleration_offsets_.size(); ++i)
    if (acceleration_offsets_[i] >= 0) acceleration_message_.acceleration[i] = values[acceleration_offsets_[i]];
  return output.write(accelerations_, tick, acceleration_message_);
}

}  // namespace rehearse
