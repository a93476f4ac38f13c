#include "side_recorder.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

namespace rehearse {
namespace {

constexpr std::pair<Quantity, std::vector<double> msg::JointState::*> joint_arrays[] = {
    {Quantity::q, &msg::JointState::position},
    {Quantity::dq, &msg::JointState::velocity},
    {Quantity::u, &msg::JointState::effort}};

/// The accelerations at the indices are its numbers; the others are NaN.
FixedMessage acceleration_message(const std::vector<std::string>& names, const std::vector<std::size_t>& indices) {
  msg::JointAccelerations message;
  message.name = names;
  message.acceleration.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
  auto fixed =
      FixedMessage::of(indices.size(), [&](const msg::Time& stamp, std::span<const double> numbers, CdrWriter& cdr) {
        message.header.stamp = stamp;
        for (std::size_t i = 0; i < numbers.size(); ++i) message.acceleration[indices[i]] = numbers[i];
        msg::encode(message, cdr);
      });
  REHEARSE_ASSERT(fixed, "accelerations are float64");
  return *std::move(fixed);
}

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
  std::vector<std::string> names;
  std::vector<JointElement> places;
  std::vector<std::size_t> accelerations;  // index of the joint, by number of the message
  for (const IoField& field : layout.fields) {
    if (field.quantity > Quantity::u) continue;
    if (joints.empty() || joints.back() != field.joint) {
      joints.push_back(field.joint);
      names.push_back(model.links[model.joints[field.joint]].joint.name);
    }
    const std::size_t index = joints.size() - 1;
    if (field.quantity == Quantity::ddq) {
      accelerations.push_back(index);
      acceleration_offsets_.push_back(field.offset);
    }
    for (const auto& [quantity, array] : joint_arrays) {
      if (quantity != field.quantity) continue;
      places.push_back({array, index});
      joint_offsets_.push_back(field.offset);
    }
  }
  if (!accelerations.empty()) {
    ChannelName name = of_side;
    name.kind = ChannelKind::joint_accelerations;
    acceleration_message_ = acceleration_message(names, accelerations);
    accelerations_ = output.channel<msg::JointAccelerations>(name, joint_metadata(name.kind, model, joints));
  }
  if (places.empty()) return;
  joint_message_ = joint_message(names, places);
  mcap::StringMap metadata = joint_metadata(of_side.kind, model, joints);
  metadata.insert(metadata_.begin(), metadata_.end());
  joints_ = output.channel<msg::JointState>(of_side, std::move(metadata));
}

void SideRecorder::add_link(TraceOutput& output, ChannelName name, const Model& model, const IoField& field) {
  name.kind = channel_kind_of(field.quantity);
  name.owner = model.links[field.link].name;
  links_.push_back({output.channel(name, metadata_), field, fixed_numbers(name.kind, "world")});
}

Result<void> SideRecorder::write(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) {
  REHEARSE_TRY(write_joints(output, tick, values));
  for (LinkChannel& link : links_) {
    link.message.set(std::span(values).subspan(link.field.offset, width_of(link.field.quantity)));
    REHEARSE_TRY(output.write(link.channel, tick, link.message));
  }
  return {};
}

Result<void> SideRecorder::write_joints(TraceOutput& output, std::int64_t tick, const std::vector<double>& values) {
  if (joints_) {
    for (std::size_t i = 0; i < joint_offsets_.size(); ++i) joint_message_.set(i, values[joint_offsets_[i]]);
    REHEARSE_TRY(output.write(*joints_, tick, joint_message_));
  }
  if (!accelerations_) return {};
  for (std::size_t i = 0; i < acceleration_offsets_.size(); ++i)
    acceleration_message_.set(i, values[acceleration_offsets_[i]]);
  return output.write(*accelerations_, tick, acceleration_message_);
}

}  // namespace rehearse
