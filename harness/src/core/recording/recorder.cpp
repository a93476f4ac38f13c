#include "recorder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "contact_recorder.h"
#include "copied_recording.h"
#include "core/keeper/remote_writer.h"
#include "core/kinds/vector_messages.h"
#include "device_recorder.h"
#include "provenance.h"
#include "side_recorder.h"
#include "trace_output.h"

namespace rehearse {
namespace {

constexpr double transforms_per_second = 30.0;  // for viewers: other channels contain the exact state

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

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

struct ControllerChannels {
  SideRecorder input, output;
  std::vector<std::uint16_t> contacts;        // channels by the controller's contact links
  std::vector<std::uint16_t> devices;         // channels by device index; 0: none
  std::uint16_t delay = 0;                    // 0: none yet
  std::vector<std::uint16_t> variables = {};  // channels of its variables; 0: none yet
  std::uint16_t cost = 0;                     // 0: none yet
};

struct BodyChannels {
  /// A link whose pose isn't determined by joints.
  struct FreeLink {
    int link = 0;
    std::uint16_t pose = 0, twist = 0;
  };

  std::uint16_t joints = 0, measured_joints = 0;  // 0: none
  std::vector<FreeLink> free_links;
  std::uint16_t actuators = 0;  // 0: none
  std::vector<int> actuated;    // ids of the joints with an actuator
  FixedMessage joint_message, actuator_message, pose_message, twist_message;
  std::vector<DeviceRecorder> devices;
};

/// The load report of all bodies of that file: they may have loaded it with different options, and so with different
/// repairs. Repairs that a later body shares with earlier ones are reported once.
std::string load_report(const Scenario& scenario, const std::string& model_file) {
  std::string text;
  std::set<std::string> told;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.model_file != model_file) continue;
    std::vector<std::string> lines;
    for (Diagnostic finding : body.model->report) {
      finding.file = model_file;
      lines.push_back(to_string({finding}));
    }
    for (const std::string& line : lines)
      if (told.count(line) == 0) text += line;
    told.insert(lines.begin(), lines.end());
  }
  return text;
}

/// The metadata of the channel of a device's states. Commands in initialize() act before the run.
mcap::StringMap first_words_metadata(const ControllerChannels& channels, const DeviceOutput& first) {
  mcap::StringMap metadata = channels.output.metadata();
  if (first.acted_in_initialize) metadata["since"] = "initialize";
  return metadata;
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

struct Recorder::Impl : TraceOutput {
  const Scenario& scenario;
  std::vector<BodyChannels> bodies;
  std::vector<ControllerChannels> controllers;
  mcap::StringMap devices_read;  // labels of the controllers that read a device, by BODY/DEVICE
  std::optional<ContactRecorder> contact_recorder;
  std::uint16_t tick_channel = 0, transform_channel = 0, checkpoint_channel = 0, event_channel = 0;
  std::uint16_t joystick_channel = 0;   // 0: none
  std::set<int> measured_bodies;        // bodies whose joint readings differ from the truth
  std::int64_t transform_interval = 1;  // [ticks]
  bool inputs_are_written = false;      // of the present tick
  msg::Tick tick_message;
  msg::TFMessage transforms;
  msg::Joy joystick_message;

  explicit Impl(const Scenario& of) : TraceOutput(of.time_step), scenario(of) {}

  Result<void> attach_sources();
  void declare_body(const ScenarioBody& body);
  void declare_controllers(const ControllerHost& host);
  Result<void> write_joints(std::int64_t tick, BodyChannels& channels, std::uint16_t channel,
                            const std::vector<JointReading>& joints);
  Result<void> write_actuators(std::int64_t tick, BodyChannels& channels,
                               const std::vector<ActuatorReading>& actuators);
  Result<void> write_body(std::int64_t tick, std::size_t index, const BodyObservation& seen,
                          const std::vector<JointReading>& read);
  Result<void> write_transforms(std::int64_t tick, const Observation& seen);
  Result<void> write_joystick(std::int64_t tick, const JoystickReading& reading);
  Result<void> write_inputs(std::int64_t tick, const HostedController& hosted, ControllerChannels& channels);
  Result<void> close_tick(std::int64_t tick, const TickHashes& hashes);
  Result<void> write_delay(std::int64_t tick, const HostedController& hosted, ControllerChannels& channels);
  Result<void> write_variables(std::int64_t tick, const HostedController& hosted, std::vector<std::uint16_t>& channels);
  Result<void> write_cost(std::int64_t tick, const HostedController& hosted, std::uint16_t& channel);
};

Recorder::Recorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Recorder::~Recorder() = default;
const RecordingSize& Recorder::size() const { return impl_->size; }
bool Recorder::is_changed_by_others() const { return impl_->writer->is_changed_by_others(); }
int Recorder::descriptor() const { return impl_->writer->descriptor(); }

Result<std::unique_ptr<Recorder>> Recorder::create(const std::filesystem::path& file, const Scenario& scenario,
                                                   const mcap::StringMap& provenance) {
  auto impl = std::make_unique<Impl>(scenario);
  auto writer = REHEARSE_TRY(create_recording(file));
  impl->writer = std::move(writer);
  REHEARSE_TRY(impl->attach_sources());
  REHEARSE_TRY(impl->writer->add_metadata(records::provenance, provenance));
  return std::unique_ptr<Recorder>(new Recorder(std::move(impl)));
}

namespace {

/// The media type of the file that a model was read from: a URDF, a .body file, or a heightmap.
const char* media_type_of(const ScenarioBody& body) {
  const Link& root = body.model->links.front();
  const Mesh* mesh = root.visuals.empty() ? nullptr : std::get_if<Mesh>(&root.visuals.front().geometry);
  const std::string ending = std::filesystem::path(body.model_file).extension();
  if (ending == ".wrl") return "model/vrml";
  if (ending == ".body" || ending == ".yaml" || ending == ".yml") return "application/yaml";
  if (!mesh || !mesh->heightmap) return "application/xml";
  return mesh->file.ends_with(".png") ? "image/png" : "text/plain";
}

}  // namespace

Result<void> Recorder::Impl::attach_sources() {
  for (const SourceFile& source : sources_of(scenario))
    REHEARSE_TRY(writer->add_attachment(source.name, source.media_type, bytes_of(source.text)));
  return {};
}

std::vector<SourceFile> sources_of(const Scenario& scenario) {
  std::vector<SourceFile> sources{{"scenario.yaml", "application/yaml", scenario.text}};
  std::set<std::string> attached;
  for (const ScenarioBody& body : scenario.bodies) {
    if (body.model_file.empty() || !attached.insert(body.model_file).second) continue;
    sources.push_back({body.model_file, media_type_of(body), body.model->source_text});
    sources.push_back({body.model_file + ".report", "text/plain", load_report(scenario, body.model_file)});
    std::string meshes = mesh_digests(*body.model);
    if (!meshes.empty()) sources.push_back({body.model_file + ".meshes", "text/plain", std::move(meshes)});
  }
  return sources;
}

std::map<std::string, mcap::StringMap> Recorder::channels_of(const Scenario& scenario, const ControllerHost& host) {
  Recorder recorder(std::make_unique<Impl>(scenario));
  recorder.declare(&host);
  return std::move(recorder.impl_->listed);
}

Result<void> Recorder::attach(const std::string& name, const std::string& media_type, const std::string& text) {
  return impl_->writer->add_attachment(name, media_type, bytes_of(text));
}

Result<void> Recorder::add_metadata(const std::string& name, const mcap::StringMap& values) {
  return impl_->writer->add_metadata(name, values);
}

void Recorder::declare(const ControllerHost* host) {
  Impl& impl = *impl_;
  for (const ScenarioBody& body : impl.scenario.bodies) impl.declare_body(body);
  if (impl.scenario.joystick)
    impl.joystick_channel = impl.channel<msg::Joy>(ChannelName::of_run(ChannelKind::joystick),
                                                   {{"axes", fmt::format("{}", fmt::join(joystick_axes, " "))},
                                                    {"buttons", fmt::format("{}", fmt::join(joystick_buttons, " "))}});
  if (host) impl.declare_controllers(*host);
  if (impl.writer) add_metadata_at_failure(*impl.writer, records::devices_read, impl.devices_read);
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
                           std::vector<std::uint16_t>(model.devices.size(), 0)});
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
  return write(channels.actuators, tick, message);
}

Result<void> Recorder::Impl::write_body(std::int64_t tick, std::size_t index, const BodyObservation& seen,
                                        const std::vector<JointReading>& read) {
  BodyChannels& channels = bodies[index];
  if (channels.joints) REHEARSE_TRY(write_joints(tick, channels, channels.joints, seen.joints));
  if (channels.measured_joints) REHEARSE_TRY(write_joints(tick, channels, channels.measured_joints, read));
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
  return write(joystick_channel, tick, joystick_message);
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
      std::uint16_t& channel = channels.devices[output.device];
      if (!channel)  // most controllers command no device: the channel is added with the first command
        channel = impl.channel<msg::DeviceState>(
            ChannelName::of_controller(hosted.label, ChannelSide::output, ChannelKind::device_state,
                                       model.devices[output.device].name),
            first_words_metadata(channels, output));
      msg::DeviceState state;
      state.header = {impl.stamp(tick),
                      impl.scenario.bodies[hosted.body].name + "/" + model.devices[output.device].name};
      state.values = output.values;
      REHEARSE_TRY(impl.write(channel, tick, state));
    }
    REHEARSE_TRY(impl.write_variables(tick, hosted, channels.variables));
    if (host->counts_costs() && hosted.tick.has_output) REHEARSE_TRY(impl.write_cost(tick, hosted, channels.cost));
  }
  if (host) ++impl.size.ticks;
  return impl.close_tick(tick, hashes);
}

Result<void> Recorder::record_inputs(std::int64_t tick, const ControllerHost& host, const TickHashes& hashes) {
  Impl& impl = *impl_;
  if (!writes_pending(*impl.writer)) return {};
  // The outputs of a controller come between its inputs and those of the next: of several the inputs are pending.
  impl.inputs_are_written = impl.controllers.size() == 1;
  if (impl.inputs_are_written) REHEARSE_TRY(impl.write_inputs(tick, host.controllers()[0], impl.controllers[0]));
  const PendingMessages pending(*impl.writer);
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
  return write(channels.delay, tick, msg::Float64{hosted.tick.delayed ? 1.0 : 0.0});
}

/// Writes a message for each variable that was set in this tick. Its channel is added with the first message.
Result<void> Recorder::Impl::write_variables(std::int64_t tick, const HostedController& hosted,
                                             std::vector<std::uint16_t>& channels) {
  const std::vector<ControllerVariables::Variable>& variables = hosted.variables.all();
  channels.resize(variables.size(), 0);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (!variables[i].is_set) continue;
    if (!channels[i]) channels[i] = channel<msg::Float64>(ChannelName::of_variable(hosted.label, variables[i].name));
    REHEARSE_TRY(write(channels[i], tick, msg::Float64{variables[i].value}));
  }
  return {};
}

/// Writes the costs of the call in this tick. The channel is added with the first message.
Result<void> Recorder::Impl::write_cost(std::int64_t tick, const HostedController& hosted, std::uint16_t& cost) {
  if (!cost)
    cost = channel<msg::ControlCost>(ChannelName::of_controller(hosted.label, ChannelSide::none, ChannelKind::cost));
  msg::ControlCost message = hosted.tick.cost;
  message.stamp = stamp(tick);
  return write(cost, tick, message);
}

void Recorder::measure_joints(int body) { impl_->measured_bodies.insert(body); }

Result<void> Recorder::copy(const mcap::Message& message, const mcap::Schema& schema, const std::string& topic) {
  return copy_message(message, schema, topic, *impl_);
}

Result<void> Recorder::copy_chunk(const mcap::StoredChunk& chunk, const mcap::Reader& other) {
  return rehearse::copy_chunk(chunk, other, *impl_);
}

bool Recorder::begins_like(const mcap::Reader& other) const { return rehearse::begins_like(*impl_, other); }

void Recorder::count_pictures(const mcap::Message& message, const mcap::Schema& schema) {
  rehearse::count_pictures(message, schema, impl_->size);
}

Result<void> Recorder::record_measured_joints(std::int64_t tick, int body, const std::vector<JointReading>& joints) {
  BodyChannels& channels = impl_->bodies[static_cast<std::size_t>(body)];
  REHEARSE_ASSERT(channels.measured_joints, "measure_joints() was called before declare()");
  return impl_->write_joints(tick, channels, channels.measured_joints, joints);
}

Result<void> Recorder::record_reading(std::int64_t tick, int body, int device, const DeviceReading& reading) {
  BodyChannels& channels = impl_->bodies[static_cast<std::size_t>(body)];
  return channels.devices[static_cast<std::size_t>(device)].write(*impl_, tick, reading);
}

Result<void> Recorder::record_joystick(std::int64_t tick, const JoystickReading& reading) {
  return impl_->write_joystick(tick, reading);
}

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
