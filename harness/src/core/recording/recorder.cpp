#include "recorder.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "core/keeper/remote_writer.h"
#include "core/kinds/vector_messages.h"
#include "provenance.h"
#include "recorded_sources.h"
#include "recorder_impl.h"

namespace rehearse {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

/// The metadata of the channel of a device's states. Commands in initialize() act before the run.
mcap::StringMap first_words_metadata(const ControllerChannels& channels, const DeviceOutput& first) {
  mcap::StringMap metadata = channels.output.metadata();
  if (first.acted_in_initialize) metadata["since"] = "initialize";
  return metadata;
}

}  // namespace

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;
const RecordingSize& Recorder::size() const { return impl_->size; }
bool Recorder::is_changed_by_others() const { return impl_->writer->is_changed_by_others(); }
int Recorder::descriptor() const { return impl_->writer->descriptor(); }

Result<std::unique_ptr<Recorder>> Recorder::create(const std::filesystem::path& file, const Scenario& scenario,
                                                   const mcap::StringMap& provenance) {
  auto impl = std::make_unique<Impl>(scenario);
  auto recording = REHEARSE_TRY(create_recording(file));
  impl->writer = std::move(recording.writer);
  impl->supervised = recording.supervised;
  REHEARSE_TRY(impl->attach_sources());
  REHEARSE_TRY(impl->writer->add_metadata(records::provenance, provenance));
  return std::unique_ptr<Recorder>(new Recorder(std::move(impl)));
}

Result<void> Recorder::Impl::attach_sources() {
  for (const SourceFile& source : sources_of(scenario))
    REHEARSE_TRY(writer->add_attachment(source.name, source.media_type, bytes_of(source.text)));
  return {};
}

Result<void> Recorder::attach(const std::string& name, const std::string& media_type, const std::string& text) {
  return impl_->writer->add_attachment(name, media_type, bytes_of(text));
}

Result<void> Recorder::add_metadata(const std::string& name, const mcap::StringMap& values) {
  return impl_->writer->add_metadata(name, values);
}

Result<void> Recorder::record_state(std::int64_t tick, const Observation& seen, const Observation& read) {
  for (std::size_t i = 0; i < seen.bodies.size(); ++i)
    REHEARSE_TRY(impl_->write_body(tick, i, seen.bodies[i], read.bodies[i].joints));
  if (seen.joystick) REHEARSE_TRY(impl_->write_joystick(tick, *seen.joystick));
  if (tick % impl_->transform_interval != 0) return {};
  return impl_->write_transforms(tick, seen);
}

Result<void> Recorder::record_truths(std::int64_t tick, const std::vector<TrueReading>& truths) {
  for (const TrueReading& truth : truths) {
    const BodyChannels& channels = impl_->bodies[static_cast<std::size_t>(truth.body)];
    const DeviceRecorder& device = channels.devices[static_cast<std::size_t>(truth.device)];
    REHEARSE_TRY(device.write_truth(*impl_, tick, truth.values));
  }
  return {};
}

Result<void> Recorder::Impl::write_joints(std::int64_t tick, BodyChannels& channels, std::uint16_t channel,
                                          const std::vector<JointReading>& joints) {
  FixedMessage& message = channels.joint_message;
  for (std::size_t id = 0; id < joints.size(); ++id) {
    message.set(3 * id, joints[id].q);
    message.set(3 * id + 1, joints[id].dq);
    message.set(3 * id + 2, joints[id].u);
  }
  return write(channel, tick, message);
}

Result<void> Recorder::Impl::write_actuators(std::int64_t tick, BodyChannels& channels,
                                             const std::vector<ActuatorReading>& actuators) {
  FixedMessage& message = channels.actuator_message;
  for (std::size_t i = 0; i < channels.actuated.size(); ++i) {
    const ActuatorReading& reading = actuators[static_cast<std::size_t>(channels.actuated[i])];
    message.set(3 * i, reading.q);
    message.set(3 * i + 1, reading.dq);
    message.set(3 * i + 2, reading.effort);
  }
  return write(*channels.actuators, tick, message);
}

Result<void> Recorder::Impl::write_body(std::int64_t tick, std::size_t index, const BodyObservation& seen,
                                        const std::vector<JointReading>& read) {
  BodyChannels& channels = bodies[index];
  if (channels.joints) REHEARSE_TRY(write_joints(tick, channels, *channels.joints, seen.joints));
  if (channels.measured_joints) REHEARSE_TRY(write_joints(tick, channels, *channels.measured_joints, read));
  if (channels.actuators) REHEARSE_TRY(write_actuators(tick, channels, seen.actuators));
  for (const BodyChannels::FreeLink& free : channels.free_links) {
    const LinkReading& link = seen.links[free.link];
    channels.pose_message.set({link.position.data(), 3});
    channels.pose_message.set({link.rotation.coeffs().data(), 4}, 3);
    channels.twist_message.set({link.velocity.data(), 3});
    channels.twist_message.set({link.angular_velocity.data(), 3}, 3);
    REHEARSE_TRY(write(free.pose, tick, channels.pose_message));
    REHEARSE_TRY(write(free.twist, tick, channels.twist_message));
  }
  for (std::size_t i = 0; i < seen.devices.size(); ++i) {
    if (!seen.devices[i].fresh) continue;
    REHEARSE_TRY(channels.devices[i].write(*this, tick, seen.devices[i]));
  }
  return {};
}

Result<void> Recorder::Impl::write_transforms(std::int64_t tick, const Observation& seen) {
  std::size_t count = 0;
  const auto next = [&](auto name) -> msg::Transform& {
    if (count == transforms.transforms.size()) {
      msg::TransformStamped& added = transforms.transforms.emplace_back();
      added.header.frame_id = "world";
      added.child_frame_id = name();
    }
    transforms.transforms[count].header.stamp = stamp(tick);
    return transforms.transforms[count++].transform;
  };
  for (std::size_t b = 0; b < seen.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    const std::vector<LinkReading>& links = seen.bodies[b].links;
    for (std::size_t i = 0; i < links.size(); ++i)
      next([&] { return body.name + "/" + body.model->links[i].name; }) = {
          vector3(links[i].position), quaternion(links[i].rotation.coeffs().data())};
    for (const Device& device : body.model->devices) {
      const MessageFrame* frame = message_frame(device);
      if (!frame) continue;
      const LinkReading& link = links[device.link];
      const Eigen::Vector3d place = link.position + link.rotation * device.pose.translation();
      const Eigen::Quaterniond turn =
          link.rotation * Eigen::Quaterniond(Eigen::Matrix3d(device.pose.linear() * frame->axes()));
      next([&] { return frame_of(body.name, device); }) = {vector3(place), quaternion(turn.coeffs().data())};
    }
  }
  return write(transform_channel, tick, transforms);
}

Result<void> Recorder::Impl::write_joystick(std::int64_t tick, const JoystickReading& reading) {
  joystick_message.header.stamp = stamp(tick);
  joystick_message.axes.assign(reading.axes.begin(), reading.axes.end());
  joystick_message.buttons.assign(reading.buttons.begin(), reading.buttons.end());
  return write(*joystick_channel, tick, joystick_message);
}

Result<void> Recorder::record_tick(std::int64_t tick, const ControllerHost* host, const TickHashes& hashes) {
  Impl& impl = *impl_;
  msg::Tick& message = impl.tick_message;
  message.controller_results.clear();
  const bool inputs_are_written = std::exchange(impl.inputs_are_written, false);
  for (std::size_t c = 0; host && c < impl.controllers.size(); ++c) {
    const HostedController& hosted = host->controllers()[c];
    message.controller_results.push_back(hosted.tick.result);
    ControllerChannels& channels = impl.controllers[c];
    if (!inputs_are_written) REHEARSE_TRY(impl.write_inputs(tick, hosted, channels));
    if (hosted.tick.has_output) REHEARSE_TRY(channels.output.write(impl, tick, hosted.io->output_values()));
    REHEARSE_TRY(impl.write_delay(tick, hosted, channels));
    for (const DeviceOutput& output : hosted.tick.device_outputs) {
      const Model& model = *impl.scenario.bodies[hosted.body].model;
      std::optional<std::uint16_t>& channel = channels.devices[output.device];
      if (!channel)  // most controllers command no device: the channel is added with the first command
        channel = impl.channel<msg::DeviceState>(
            ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::device_state,
                                       model.devices[output.device].name),
            first_words_metadata(channels, output));
      msg::DeviceState state;
      state.header = {impl.stamp(tick),
                      impl.scenario.bodies[hosted.body].name + "/" + model.devices[output.device].name};
      state.values = output.values;
      REHEARSE_TRY(impl.write(*channel, tick, state));
    }
    REHEARSE_TRY(impl.write_variables(tick, hosted, channels.variables));
    if (host->counts_costs() && hosted.tick.has_output) REHEARSE_TRY(impl.write_cost(tick, hosted, channels.cost));
  }
  if (host) ++impl.size.ticks;
  return impl.close_tick(tick, hashes);
}

Result<void> Recorder::record_inputs(std::int64_t tick, const ControllerHost& host, const TickHashes& hashes) {
  Impl& impl = *impl_;
  if (!impl.supervised) return {};
  // The outputs of a controller come between its inputs and those of the next: of several the inputs are pending.
  impl.inputs_are_written = impl.controllers.size() == 1;
  if (impl.inputs_are_written) REHEARSE_TRY(impl.write_inputs(tick, host.controllers()[0], impl.controllers[0]));
  const PendingMessages pending(*impl.supervised);
  const RecordingSize size = impl.size;
  for (std::size_t c = 0; !impl.inputs_are_written && c < impl.controllers.size(); ++c)
    REHEARSE_TRY(impl.write_inputs(tick, host.controllers()[c], impl.controllers[c]));
  impl.tick_message.controller_results.assign(impl.controllers.size(), false);
  auto done = impl.close_tick(tick, hashes);
  impl.size = size;
  return done;
}

/// Also for a controller that then fails, because its inputs may be the cause.
Result<void> Recorder::Impl::write_inputs(std::int64_t tick, const HostedController& hosted,
                                          ControllerChannels& channels) {
  if (!hosted.tick.has_input) return {};
  REHEARSE_TRY(channels.input.write(*this, tick, hosted.io->input_values()));
  return contact_recorder->write_input(*this, tick, channels.contacts, hosted.io->input_contacts());
}

/// Writes the message that closes a tick. Its results are set.
Result<void> Recorder::Impl::close_tick(std::int64_t tick, const TickHashes& hashes) {
  tick_message.stamp = stamp(tick);
  tick_message.tick = tick;
  tick_message.state_hash = hashes.state;
  tick_message.input_hash = hashes.input;
  tick_message.output_hash = hashes.output;
  return write(tick_channel, tick, tick_message);
}

/// Writes the delay of commands that don't act at the time that their channels state.
Result<void> Recorder::Impl::write_delay(std::int64_t tick, const HostedController& hosted,
                                         ControllerChannels& channels) {
  if (!hosted.acts_at_another_time()) return {};
  if (!channels.delay)
    channels.delay =
        channel<msg::Float64>(ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::delay));
  return write(*channels.delay, tick, msg::Float64{hosted.tick.delayed ? 1.0 : 0.0});
}

/// Writes a message for each variable that was set in this tick. Its channel is added with the first message.
Result<void> Recorder::Impl::write_variables(std::int64_t tick, const HostedController& hosted,
                                             std::vector<std::optional<std::uint16_t>>& channels) {
  const std::vector<ControllerVariables::Variable>& variables = hosted.variables.all();
  channels.resize(variables.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!variables[i].is_set) continue;
    if (!channels[i]) channels[i] = channel<msg::Float64>(ChannelName::of_variable(hosted.label, variables[i].name));
    REHEARSE_TRY(write(*channels[i], tick, msg::Float64{variables[i].value}));
  }
  return {};
}

/// Writes the costs of the call in this tick. The channel is added with the first message.
Result<void> Recorder::Impl::write_cost(std::int64_t tick, const HostedController& hosted,
                                        std::optional<std::uint16_t>& cost) {
  if (!cost)
    cost = channel<msg::ControlCost>(ChannelName::of_controller(hosted.label, ChannelSide::none, ChannelKind::cost));
  msg::ControlCost message = hosted.tick.cost;
  message.stamp = stamp(tick);
  return write(*cost, tick, message);
}

void Recorder::measure_joints(int body) { impl_->measured_bodies.insert(body); }

void Recorder::begin_with_contacts(const std::vector<LinkPair>& touching) {
  impl_->contact_recorder->begin_with(touching);
}

Result<void> Recorder::record_contacts(std::int64_t tick, const std::vector<LinkPair>& touching) {
  return impl_->contact_recorder->write(*impl_, tick, touching);
}

Result<void> Recorder::record_checkpoint(std::int64_t tick, std::span<const std::byte> state) {
  msg::Checkpoint message;
  message.stamp = impl_->stamp(tick);
  message.tick = tick;
  message.format = checkpoint_format;
  message.data.resize(state.size());
  std::memcpy(message.data.data(), state.data(), state.size());
  return impl_->write(impl_->checkpoint_channel, tick, message);
}

Result<void> Recorder::record_events(const std::vector<msg::Event>& events) {
  for (const msg::Event& event : events) REHEARSE_TRY(impl_->write(impl_->event_channel, event.tick, event));
  return {};
}

Result<void> Recorder::close(const RunOutcome& outcome) {
  REHEARSE_TRY(impl_->writer->add_metadata(records::devices_read, impl_->devices_read));
  REHEARSE_TRY(impl_->writer->add_metadata(records::outcome, outcome.metadata()));
  return impl_->writer->close();
}

}  // namespace rehearse
