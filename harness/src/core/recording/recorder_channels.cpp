#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/keeper/remote_writer.h"
#include "core/kinds/vector_messages.h"
#include "recorder_impl.h"

namespace rehearse {
namespace {

constexpr double transforms_per_second = 30.0;  // for viewers: other channels contain the exact state

/// Adds the bounds that the simulation enforces for the joints of this body because the scenario requests it.
void add_limits(const ScenarioBody& body, mcap::StringMap& metadata) {
  const auto state = [&metadata](const std::string& element, double lower, double upper) {
    if (std::isfinite(lower) || std::isfinite(upper))
      metadata["limits:" + element] = fmt::format("{} {}", lower, upper);
  };
  for (const int link : body.model->joints) {
    const Joint& joint = body.model->links[link].joint;
    if (body.joint_limits.value_or(false)) state(joint.name + "/q", joint.lower, joint.upper);
    if (body.effort_limits) state(joint.name + "/u", -joint.effort, joint.effort);
  }
}

/// Its numbers are displacement, velocity and effort of each joint. `joints`: ids.
FixedMessage message_of_joints(const Model& model, const std::vector<int>& joints) {
  std::vector<std::string> names;
  std::vector<JointElement> places;
  for (const int id : joints) {
    const std::size_t index = names.size();
    names.push_back(model.links[model.joints[id]].joint.name);
    for (const auto array : {&msg::JointState::position, &msg::JointState::velocity, &msg::JointState::effort})
      places.push_back({array, index});
  }
  return joint_message(names, places);
}

bool is_free(const ScenarioBody& body, int link) {
  const bool is_fixed_root = link == 0 && body.fixed;
  return !is_fixed_root && body.model->links[static_cast<std::size_t>(link)].joint.type == JointType::free;
}

}  // namespace

std::map<std::string, mcap::StringMap> Recorder::channels_of(const Scenario& scenario, const ControllerHost& host) {
  Recorder recorder(std::make_unique<Impl>(scenario));
  recorder.declare(&host);
  return std::move(recorder.impl_->listed);
}

void Recorder::declare(const ControllerHost* host) {
  Impl& impl = *impl_;
  for (const ScenarioBody& body : impl.scenario.bodies) impl.declare_body(body);
  if (impl.scenario.joystick)
    impl.joystick_channel = impl.channel<msg::Joy>(ChannelName::of_run(ChannelKind::joystick),
                                                   {{"axes", fmt::format("{}", fmt::join(joystick_axes, " "))},
                                                    {"buttons", fmt::format("{}", fmt::join(joystick_buttons, " "))}});
  if (host) impl.declare_controllers(*host);
  if (impl.supervised) impl.supervised->add_metadata_at_failure(records::devices_read, impl.devices_read);
  impl.transform_channel = impl.channel<msg::TFMessage>(ChannelName::of_run(ChannelKind::transforms));
  impl.contact_recorder.emplace(impl, impl.scenario);
  impl.checkpoint_channel = impl.channel<msg::Checkpoint>(ChannelName::of_run(ChannelKind::checkpoint));
  impl.event_channel = impl.channel<msg::Event>(ChannelName::of_run(ChannelKind::events));
  impl.tick_channel = impl.channel<msg::Tick>(ChannelName::of_run(ChannelKind::tick));
  impl.transform_interval =
      std::max<std::int64_t>(1, std::llround(1.0 / (transforms_per_second * impl.scenario.time_step)));
}

void Recorder::Impl::declare_controllers(const ControllerHost& host) {
  for (const HostedController& hosted : host.controllers()) {
    const ScenarioBody& body = scenario.bodies[hosted.body];
    const Model& model = *body.model;
    SideRecorder input(*this, hosted.label, ChannelSide::input, model, hosted.io->inputs());
    std::vector<std::uint16_t> contacts;
    for (const int link : hosted.io->contact_links())
      contacts.push_back(channel<msg::Contacts>(
          ChannelName::of_controller(hosted.label, ChannelSide::input, ChannelKind::contacts, model.links[link].name)));
    for (const int device : hosted.io->input_devices()) {
      std::string& readers = devices_read[body.name + "/" + model.devices[device].name];
      readers += (readers.empty() ? "" : ", ") + hosted.label;
    }
    SideRecorder output(*this, hosted.label, ChannelSide::output, model, hosted.io->outputs(),
                        {{"delay", hosted.delayed ? "true" : "false"}});
    controllers.push_back({std::move(input), std::move(output), std::move(contacts),
                           std::vector<std::optional<std::uint16_t>>(model.devices.size())});
  }
}

void Recorder::Impl::declare_body(const ScenarioBody& body) {
  BodyChannels& channels = bodies.emplace_back();
  const Model& model = *body.model;
  if (!model.joints.empty()) {
    std::vector<int> all;
    for (std::size_t id = 0; id < model.joints.size(); ++id) all.push_back(static_cast<int>(id));
    channels.joint_message = message_of_joints(model, all);
    mcap::StringMap metadata = joint_metadata(ChannelKind::joints, model, all);
    const mcap::StringMap units = metadata;
    add_limits(body, metadata);
    channels.joints =
        channel<msg::JointState>(ChannelName::of_body(body.name, ChannelKind::joints), std::move(metadata));
    if (body.errors.disturbs_joints() || measured_bodies.count(static_cast<int>(bodies.size()) - 1) > 0)
      channels.measured_joints =
          channel<msg::JointState>(ChannelName::of_body(body.name, ChannelKind::measured_joints), units);
  }
  for (std::size_t id = 0; id < body.actuators.size(); ++id) {
    if (body.actuators[id]) channels.actuated.push_back(static_cast<int>(id));
  }
  if (!channels.actuated.empty()) {
    channels.actuator_message = message_of_joints(model, channels.actuated);
    channels.actuators = channel<msg::JointState>(ChannelName::of_body(body.name, ChannelKind::actuators),
                                                  joint_metadata(ChannelKind::actuators, model, channels.actuated));
  }
  channels.pose_message = fixed_numbers(ChannelKind::pose, "world");
  channels.twist_message = fixed_numbers(ChannelKind::twist, "world");
  for (int link = 0; link < static_cast<int>(model.links.size()); ++link) {
    if (!is_free(body, link)) continue;
    const auto of_link = [&](ChannelKind kind) {
      return ChannelName::of_owner(body.name, model.links[link].name, kind);
    };
    BodyChannels::FreeLink& free = channels.free_links.emplace_back(BodyChannels::FreeLink{link});
    free.pose = channel<msg::PoseStamped>(of_link(ChannelKind::pose));
    free.twist = channel<msg::TwistStamped>(of_link(ChannelKind::twist));
  }
  for (const Device& device : model.devices) channels.devices.emplace_back(*this, scenario, body, device);
  for (std::size_t i = 0; i < body.errors.devices.size(); ++i)
    if (value_count(model.devices[i]) > 0 && body.errors.devices[i].records_truth())
      channels.devices[i].declare_truth(*this, body);
}

}  // namespace rehearse
