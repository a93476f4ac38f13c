#include "side_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/kinds/vector_messages.h"

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
  links_.push_back({output.channel(name, metadata_), field, form_of(name.kind).numbers});
}

Result<void> SideRecorder::write(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) {
  if (auto done = write_joints(output, tick, values); !done) return done;
  const msg::Header header{output.stamp(tick), "world"};
  for (const LinkChannel& link : links_) {
    const std::span numbers = std::span(values).subspan(link.field.offset, width_of(link.field.quantity));
    link_message_.reset();
    link.message->encode(header, numbers, link_message_);
    if (auto done = output.write_encoded(link.channel, tick, link_message_.bytes()); !done) return done;
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
