#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/body.h>
#include <rehearse/controller_bench.h>
#include <rehearse/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "base/clock.h"
#include "core/guard/cost_counter.h"
#include "core/host/controller_host.h"
#include "core/kinds/cost_fields.h"
#include "core/run/hosted_commands.h"
#include "core/run/run.h"
#include "core/scenario/body_faults.h"
#include "core/simulation/sensor_errors.h"
#include "model/acting_faults.h"
#include "realtime_assertions.h"

namespace rehearse {
namespace {

template <class T>
T value_or_throw(Result<T> result, const CallPlace& from) {
  if (!result) throw std::runtime_error(message_at(from, to_string(result.errors())));
  return std::move(*result);
}

/// The number of values that a test may set: values, or a range sensor's distances.
std::size_t numbers_of(const Device& device) {
  const auto* laser = std::get_if<RangeSensor>(&device.kind);
  return static_cast<std::size_t>(laser ? laser->beams() : value_count(device));
}

/// There are few names here, so messages list all of them.
template <class Names>
[[noreturn]] void unknown(const CallPlace& from, std::string_view owner, std::string_view what, std::string_view name,
                          const Names& names) {
  throw std::out_of_range(
      message_at(from, fmt::format("the {} has no {} \"{}\"; it has {}", owner, what, name,
                                   names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")))));
}

}  // namespace

struct ControllerBench::Impl final : ObservationSource, Sink {
  Scenario scenario;
  std::unique_ptr<ControllerHost> host;
  Observation seen, read;                               // without and with the faults of sensors
  std::optional<SensorErrors> errors;                   // of sensors and encoders
  std::vector<BenchJoint> joints;                       // by joint id
  std::vector<std::uint8_t> commanded;                  // by joint id: the quantities, as JointCommand::drive
  std::vector<BenchLink> links;                         // by link index
  std::vector<BenchDevice> devices;                     // by device index
  std::vector<std::shared_ptr<const Image>> delivered;  // by device index: the last delivered picture
  std::array<double, joystick_axes.size()> axes{};
  std::array<bool, joystick_buttons.size()> buttons{};
  std::vector<std::string> messages;
  std::optional<HostedCommands> commands;
  std::optional<Run> run;
  CallPlace called_from;  // the constructor or the tick that is under way

  const Model& model() const { return *scenario.bodies[0].model; }
  void set_up(const std::string& library, const std::string& model_file, const BenchOptions& options);
  Result<bool> observe(TickData& now) override;
  Result<void> emit(const TickData& now) override;
  Result<bool> advance(TickData&, Commander&) override { return true; }  // nothing moves by itself
  void observe_device(std::size_t index, std::int64_t tick);
  void observe_joystick();
  void require_joystick(std::string_view what, const CallPlace& from) const;
  void read_outputs();
  void apply_faults(double time);
  void check();
};

ControllerBench::ControllerBench(const std::string& library, const std::string& model, const BenchOptions& options,
                                 const CallPlace& from)
    : impl_(std::make_unique<Impl>()) {
  impl_->called_from = from;
  impl_->set_up(library, model, options);
}

ControllerBench::~ControllerBench() = default;
double ControllerBench::time() const { return time_of(ticks(), impl_->scenario.time_step); }
std::int64_t ControllerBench::ticks() const { return impl_->run->tick(); }
const std::vector<std::string>& ControllerBench::messages() const { return impl_->messages; }

void ControllerBench::Impl::set_up(const std::string& library, const std::string& model_file,
                                   const BenchOptions& options) {
  scenario.file = fixture_path("bench");  // makes paths relative to the fixtures
  scenario.name = "bench";
  scenario.time_step = options.time_step;
  ScenarioBody& body = scenario.bodies.emplace_back();
  body.model_file = fixture_path(model_file);
  body.model = std::make_shared<const Model>(value_or_throw(load_model(body.model_file), called_from));
  body.name = model().name;
  body.fixed = model().links[0].joint.type == JointType::fixed;
  body.position = options.position;
  body.joints.assign(model().joints.size(), 0.0);
  for (const auto& [name, q] : options.joints) {
    const int link = model().find_joint(name);
    if (link < 0 || model().links[link].joint.id < 0)
      throw std::out_of_range(message_at(called_from, fmt::format("the model has no joint \"{}\"", name)));
    body.joints[model().links[link].joint.id] = q;
  }
  ScenarioController& controller = body.controllers.emplace_back();
  controller.name = controller.library = library;
  controller.options = options.options;
  controller.place.file = "ControllerBench";
  if (options.joystick) scenario.joystick.emplace();
  if (const auto added = add_faults(body, options.faults.entries()); !added)
    throw std::invalid_argument(message_at(called_from, to_string(added.errors())));
  if (!body.errors.devices.empty() || !body.errors.joints.empty()) errors.emplace(scenario);

  seen = initial_observation(scenario);
  for (const JointReading& joint : seen.bodies[0].joints) joints.push_back({joint.q, 0.0, 0.0, 0.0, joint.q, 0.0});
  for (const LinkReading& link : seen.bodies[0].links) {
    BenchLink& made = links.emplace_back();
    made.position = link.position;
    made.rotation = link.rotation;
  }
  devices.resize(model().devices.size());
  delivered.resize(model().devices.size());
  HostOptions counting;
  counting.counts_costs = can_count_costs();
  host = value_or_throw(ControllerHost::create(scenario, counting), called_from);
  host->initialize(seen);
  host->start();
  check();
  commands.emplace(*host, HostedCommands::Written::never);
  run.emplace(scenario.time_step, *this, *commands, *this, 0, Run::no_end);
}

/// Reads the host's messages, and throws if the controller has failed.
void ControllerBench::Impl::check() {
  std::string last_error;
  for (const msg::Event& event : host->take_events()) {
    messages.push_back(event.text);
    if (event.severity == to_string(Severity::error)) last_error = event.source + ": " + event.text;
  }
  if (host->failure()) throw std::runtime_error(message_at(called_from, host->failure()->message));
  if (host->any_refused()) throw std::runtime_error(message_at(called_from, last_error));
}

Result<bool> ControllerBench::Impl::observe(TickData& now) {
  BodyObservation& body = seen.bodies[0];
  for (std::size_t i = 0; i < joints.size(); ++i)
    body.joints[i] = {joints[i].q, joints[i].dq, joints[i].ddq, joints[i].u};
  body.contacts.resize(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    const BenchLink& link = links[i];
    body.contacts[i].clear();
    for (const BenchContact& contact : link.contacts)
      body.contacts[i].push_back({contact.position, contact.normal, contact.force, contact.velocity, contact.depth});
    body.links[i] = {link.position,     Eigen::Quaterniond(link.rotation), link.velocity, link.angular_velocity,
                     link.acceleration, link.angular_acceleration};
  }
  for (std::size_t i = 0; i < devices.size(); ++i) observe_device(i, now.tick);
  if (seen.joystick) observe_joystick();
  now.seen = now.read = &seen;
  if (!errors) return true;
  read = seen;
  errors->disturb_devices(now.tick, read);
  errors->disturb_joints(now.tick, read);
  now.read = &read;
  return true;
}

void ControllerBench::Impl::observe_joystick() {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(axes[i] >= lowest_position(i) && axes[i] <= 1.0))
      throw std::invalid_argument(message_at(called_from, fmt::format("axis \"{}\" is at {}, but it goes from {} to 1",
                                                                      joystick_axes[i], axes[i], lowest_position(i))));
    seen.joystick->axes[i] = static_cast<float>(axes[i]);
  }
  seen.joystick->buttons = buttons;
}

void ControllerBench::Impl::require_joystick(std::string_view what, const CallPlace& from) const {
  if (!seen.joystick)
    throw std::logic_error(
        message_at(from, fmt::format("there is no {}: the options of the bench exclude a joystick", what)));
}

void ControllerBench::Impl::observe_device(std::size_t index, std::int64_t tick) {
  const BenchDevice& device = devices[index];
  const Device& described = model().devices[index];
  DeviceReading& reading = seen.bodies[0].devices[index];
  const std::size_t wanted = numbers_of(described);
  if (!device.values.empty() && device.values.size() != wanted)
    throw std::invalid_argument(
        message_at(called_from, fmt::format("device \"{}\" has {} values, but a {} has {}", described.name,
                                            device.values.size(), type_name(described), wanted)));
  reading.values.clear();
  reading.ranges = nullptr;
  if (!std::holds_alternative<RangeSensor>(described.kind))
    reading.values = device.values;
  else if (!device.values.empty())
    reading.ranges = std::make_shared<const std::vector<float>>(device.values.begin(), device.values.end());
  reading.measured_at = time_of(tick, scenario.time_step);
  reading.image = device.image;
  reading.depth = device.depth;
  reading.fresh = !device.values.empty() || (device.image && device.image != delivered[index]);
  delivered[index] = device.image;
}

void ControllerBench::Impl::read_outputs() {
  commanded.assign(joints.size(), drive_none);
  for (const HostedController& hosted : host->controllers()) {
    for (const IoField& field : hosted.io->outputs().fields) {
      const double* value = hosted.io->output_values().data() + field.offset;
      switch (field.quantity) {
        case Quantity::q:
          joints[field.joint].q_target = *value;
          commanded[field.joint] |= drive_displacement;
          break;
        case Quantity::dq:
          joints[field.joint].dq_target = *value;
          commanded[field.joint] |= drive_velocity;
          break;
        case Quantity::u:
          joints[field.joint].u = *value;
          commanded[field.joint] |= drive_effort;
          break;
        case Quantity::wrench:
          links[field.link].force = {value[0], value[1], value[2]};
          links[field.link].torque = {value[3], value[4], value[5]};
          break;
        default: break;  // other quantities move no robot
      }
    }
    for (const DeviceOutput& output : hosted.tick.device_outputs) devices[output.device].on = output.on;
  }
}

/// Of the quantities that the controller commands. They are new in each tick.
void ControllerBench::Impl::apply_faults(double time) {
  const std::vector<std::optional<Actuator>>& actuators = scenario.bodies[0].actuators;
  for (std::size_t id = 0; id < actuators.size(); ++id) {
    if (!actuators[id]) continue;
    BenchJoint& joint = joints[id];
    const FaultedCommand faulted = under_faults(
        actuators[id]->faults, {commanded[id], joint.q_target, joint.dq_target, joint.u}, time, scenario.time_step);
    const auto acts = [&](Drive quantity) { return (faulted.command.drive & quantity) != 0; };
    if (commanded[id] & drive_effort) joint.u = faulted.command.u;
    if (commanded[id] & drive_displacement) joint.q_target = acts(drive_displacement) ? faulted.command.q : joint.q;
    if (commanded[id] & drive_velocity) joint.dq_target = acts(drive_velocity) ? faulted.command.dq : joint.dq;
  }
}

Result<void> ControllerBench::Impl::emit(const TickData& now) {
  check();
  read_outputs();
  apply_faults(time_of(now.tick, scenario.time_step));
  return {};
}

bool ControllerBench::tick(const CallPlace& from) {
  impl_->called_from = from;
  value_or_throw(impl_->run->step(), from);
  if (impl_->run->interruption()) throw std::runtime_error(message_at(from, impl_->run->interruption()->message));
  impl_->check();  // the controller may have failed in an earlier tick
  if (internal::wants_realtime())
    if (const auto verdict = internal::judge_realtime(*this); !verdict.passed)
      throw std::runtime_error(message_at(from, verdict.message));
  return impl_->host->controllers()[0].tick.result;
}

BenchJoint& ControllerBench::joint(std::string_view name, const CallPlace& from) {
  const Model& model = impl_->model();
  const int link = model.find_joint(name);
  if (link >= 0 && model.links[link].joint.id >= 0) return impl_->joints[model.links[link].joint.id];
  std::vector<std::string> names;
  for (const int moved : model.joints) names.push_back(model.links[moved].joint.name);
  unknown(from, "model", "joint", name, names);
}

BenchLink& ControllerBench::link(std::string_view name, const CallPlace& from) {
  const Model& model = impl_->model();
  const int link = model.find_link(name);
  if (link >= 0) return impl_->links[link];
  std::vector<std::string> names;
  for (const Link& other : model.links) names.push_back(other.name);
  unknown(from, "model", "link", name, names);
}

BenchDevice& ControllerBench::device(std::string_view name, const CallPlace& from) {
  const Model& model = impl_->model();
  const int device = model.find_device(name);
  if (device >= 0) return impl_->devices[device];
  std::vector<std::string> names;
  for (const Device& other : model.devices) names.push_back(other.name);
  unknown(from, "model", "device", name, names);
}

double ControllerBench::variable(std::string_view name, const CallPlace& from) const {
  const ControllerVariables& variables = impl_->host->controllers()[0].variables;
  if (const ControllerVariables::Variable* found = variables.find(name)) return found->value;
  std::vector<std::string> names;
  for (const ControllerVariables::Variable& other : variables.all()) names.push_back(other.name);
  unknown(from, "controller", "variable", name, names);
}

double& ControllerBench::axis(std::string_view name, const CallPlace& from) {
  impl_->require_joystick("axis", from);
  if (const auto axis = find_control(joystick_axes, name)) return impl_->axes[*axis];
  unknown(from, "joystick", "axis", name, joystick_axes);
}

bool& ControllerBench::button(std::string_view name, const CallPlace& from) {
  impl_->require_joystick("button", from);
  if (const auto button = find_control(joystick_buttons, name)) return impl_->buttons[*button];
  unknown(from, "joystick", "button", name, joystick_buttons);
}

void ControllerBench::update_links() {
  Impl& bench = *impl_;
  const Eigen::Isometry3d root =
      pose_of(bench.links[0].position, Eigen::Quaterniond(bench.links[0].rotation).normalized());
  std::vector<double> q;
  for (const BenchJoint& joint : bench.joints) q.push_back(joint.q);
  const std::vector<Eigen::Isometry3d> poses = forward_kinematics(bench.model(), root, q);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::vector<BenchContact> contacts = std::move(bench.links[i].contacts);
    bench.links[i] = {};
    bench.links[i].contacts = std::move(contacts);
    bench.links[i].position = poses[i].translation();
    bench.links[i].rotation = Eigen::Quaterniond(poses[i].linear()).normalized();
  }
}

std::uint64_t ControllerBench::cost(std::string_view name, const CallPlace& from) const {
  if (!impl_->host->counts_costs())
    throw std::runtime_error(message_at(from, "the costs of control() can't be counted here"));
  std::vector<std::string_view> names;
  for (const CostField& field : cost_fields) {
    if (field.name == name) return impl_->host->controllers()[0].tick.cost.*field.count;
    names.push_back(field.name);
  }
  unknown(from, "tick", "cost", name, names);
}

std::string ControllerBench::realtime_problem() const {
  const auto verdict = internal::judge_realtime(impl_->host->control_times());
  return verdict.passed ? std::string() : verdict.message;
}

}  // namespace rehearse
