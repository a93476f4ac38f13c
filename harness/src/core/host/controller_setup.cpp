// ControllerHost: loading, configuring, initialising and starting controllers.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "cnoid_body.h"
#include "controller_host.h"
#include "controller_watch.h"
#include "core/guard/cost_counter.h"
#include "core/guard/supervisor.h"
#include "core/kinds/cost_fields.h"
#include "core/scenario/trace_scenario.h"
#include "core/turns/scheduler.h"
#include "debug_hook.h"
#include "usable_outputs.h"

namespace rehearse {
namespace {

using CnoidLink = cnoid::Link;

std::uint8_t drive_of(int mode) {
  std::uint8_t drive = drive_none;
  if (mode & CnoidLink::JointEffort) drive |= drive_effort;
  if (mode & CnoidLink::JointDisplacement) drive |= drive_displacement;
  if (mode & (CnoidLink::JointVelocity | CnoidLink::DeprecatedJointSurfaceVelocity)) drive |= drive_velocity;
  return drive;
}

/// The name of a controller's library, and the folder in which it is searched.
struct NamedLibrary {
  std::string name;
  std::filesystem::path directory;
};

NamedLibrary named_library(const Scenario& scenario, const ScenarioController& specification, const std::string& label,
                           const HostOptions& options) {
  const auto given = options.controllers.find(label);
  NamedLibrary named{given == options.controllers.end() ? specification.library : given->second.library,
                     folder_of(scenario)};
  for (const std::string& name : {specification.name, label}) {
    const auto replaced = options.libraries.find(name);
    if (replaced == options.libraries.end()) continue;
    named = {replaced->second, std::filesystem::current_path()};  // it was given on the command line
  }
  return named;
}

}  // namespace

Observation initial_observation(const Scenario& scenario) {
  Observation observation;
  for (const ScenarioBody& body : scenario.bodies) {
    BodyObservation& seen = observation.bodies.emplace_back();
    const Eigen::Isometry3d root = pose_of(body.position, body.rotation);
    for (const double q : body.joints) seen.joints.push_back({q, 0.0, 0.0, 0.0});
    for (const Eigen::Isometry3d& pose : forward_kinematics(*body.model, root, body.joints)) {
      LinkReading& link = seen.links.emplace_back();
      link.position = pose.translation();
      link.rotation = Eigen::Quaterniond(pose.linear()).normalized();
    }
    seen.devices.resize(body.model->devices.size());
  }
  if (scenario.joystick) observation.joystick = scenario.joystick->at(0.0);
  return observation;
}

Result<std::unique_ptr<ControllerHost>> ControllerHost::create(const Scenario& scenario, const HostOptions& options) {
  std::unique_ptr<ControllerHost> host(new ControllerHost);
  host->scenario_ = &scenario;
  host->options_ = options;
  TurnScheduler::instance().begin_run();
  note_memory_limit(options.memory_limit * 1e6);
  host->counts_costs_ = options.counts_costs || scenario.counts_costs;
  if (host->counts_costs_ && !can_count_costs()) {
    host->counts_costs_ = false;
    host->event(Severity::warning, std::string(uncounted_costs_source),
                fmt::format("the costs of control() can't be counted here: {}", why_no_costs));
  }
  Diagnostics findings;
  for (std::size_t b = 0; b < scenario.bodies.size(); ++b) {
    const ScenarioBody& body = scenario.bodies[b];
    host->bodies_before_.push_back(
        make_cnoid_body(*body.model, body.title.empty() ? body.name : body.title, body.fixed));
    for (const ScenarioController& specification : body.controllers) {
      const Result<void> added = host->add(specification, static_cast<int>(b), -1);
      findings.insert(findings.end(), added.errors().begin(), added.errors().end());
      const int parent = static_cast<int>(host->controllers_.size()) - 1;
      for (const ScenarioController& child : specification.children) {
        const Result<void> child_added = host->add(child, static_cast<int>(b), parent);
        findings.insert(findings.end(), child_added.errors().begin(), child_added.errors().end());
      }
    }
  }
  std::string known;
  for (const HostedController& hosted : host->controllers_) known += (known.empty() ? "" : ", ") + hosted.label;
  for (const auto& [name, library] : options.libraries) {
    bool used = false;
    for (const HostedController& hosted : host->controllers_)
      used |= name == hosted.label || name == hosted.io->controllerName();
    if (!used)
      findings.push_back(error("there is no controller '" + name + "' in " + scenario.name, "there is: " + known));
  }
  if (!findings.empty()) return findings;
  return host;
}

Result<std::filesystem::path> library_of(const Scenario& scenario, const ScenarioController& specification,
                                         const std::string& label, const HostOptions& options) {
  const NamedLibrary named = named_library(scenario, specification, label, options);
  return find_controller_library(named.name, named.directory);
}

std::string note_on_builds_of(const Scenario& scenario, const ScenarioController& specification,
                              const std::string& label, const HostOptions& options) {
  const NamedLibrary named = named_library(scenario, specification, label, options);
  return note_on_builds(named.name, named.directory);
}

Result<void> ControllerHost::add(const ScenarioController& specification, int body, int parent) {
  HostedController& hosted = controllers_.emplace_back();
  const ScenarioBody& owner = scenario_->bodies[body];
  hosted.label = owner.name + "/" + specification.name;
  hosted.specification = &specification;
  hosted.body = body;
  hosted.parent = parent;
  const auto given = options_.controllers.find(hosted.label);
  const bool is_given = given != options_.controllers.end();
  const std::string& own_options = is_given ? given->second.options : specification.options;
  const std::string& run_options = options_.run_options ? *options_.run_options : scenario_->options;
  other_options_ = other_options_ || own_options != specification.options || run_options != scenario_->options;
  hosted.io = std::make_unique<ControllerIo>(specification.name, run_options, own_options, scenario_->time_step);
  hosted.optional = is_given ? given->second.optional : specification.optional;
  hosted.io->setNoDelayMode(!(is_given ? given->second.delay : specification.delay));
  if (scenario_->joystick) hosted.joystick = std::make_unique<HostJoystick>();

  const auto file = library_of(*scenario_, specification, hosted.label, options_);
  if (!file) return at(specification.place, file.errors()[0]);
  const std::filesystem::path loaded_file = std::filesystem::absolute(*file);
  auto loaded = [&] {
    note_call_begin(hosted.label.c_str(), loading, 0, 0.0, options_.call_limit);
    const Watched watched(options_.watch, {hosted.label, loaded_file, "load"});
    return ControllerLibrary::open(loaded_file, hosted.label, options_.call_limit,
                                   is_given ? given->second.threads : specification.threads);
  }();
  note_call_end();
  if (!loaded) {
    const Diagnostic& reason = loaded.errors()[0];
    return reason.line > 0 ? reason : at(specification.place, reason);  // in a source, or in the scenario
  }
  hosted.library = *loaded;
  if (options_.keep_libraries) hosted.library->keep_loaded();
  for (const std::string& remark : hosted.library->remarks()) event(Severity::warning, hosted.label, remark);
  libraries_.push_back(*loaded);
  return {};
}

void ControllerHost::configure(HostedController& hosted) {
  hosted.io->show_body(*bodies_before_[hosted.body]);
  hosted.config = std::make_unique<cnoid::SimpleControllerConfig>(hosted.io.get());
  const bool made = call(hosted, "createSimpleController", [&] { hosted.controller.reset(hosted.library->create()); });
  if (!made) return;
  if (!hosted.controller) {
    event(Severity::error, hosted.label, "createSimpleController() returned a null pointer");
    return refuse(hosted, "createSimpleController");
  }
  bool accepted = false;
  if (!call(hosted, "configure", [&] { accepted = hosted.controller->configure(hosted.config.get()); })) return;
  hosted.configured = accepted;
  if (!accepted) refuse(hosted, "configure");
}

void ControllerHost::initialize(HostedController& hosted, const Observation& initial) {
  const ScenarioBody& body = scenario_->bodies[hosted.body];
  hosted.io_body = hosted.parent >= 0 ? controllers_[hosted.parent].io_body
                                      : std::make_shared<IoBody>(body, initial.bodies[hosted.body]);
  hosted.io->attach(*hosted.io_body);
  if (!hosted.configured) return;
  bool accepted = false;
  if (!call(hosted, "initialize", [&] { accepted = hosted.controller->initialize(hosted.io.get()); })) return;
  hosted.running = accepted;
  if (accepted && !hosted.specification->is_called)
    event(Severity::warning, hosted.label,
          "is a child of a child: it is started and stopped, and control() is never called, as in Choreonoid");
  if (accepted) return;
  refuse(hosted, "initialize");
  if (hosted.parent < 0) hosted.io_body->take_device_outputs();  // the host ignores them
}

Command ControllerHost::initialize(const Observation& initial) {
  run_ = begin_debugged_run();
  show_joystick(initial);
  for (HostedController& hosted : controllers_)
    if (!failure_) configure(hosted);
  for (HostedController& hosted : controllers_)
    if (!failure_) initialize(hosted, initial);

  Command command;
  for (const BodyObservation& body : initial.bodies) {
    BodyCommand& at_rest = command.bodies.emplace_back();
    for (const JointReading& joint : body.joints) at_rest.joints.push_back({drive_none, joint.q, 0.0, 0.0});
    at_rest.external.resize(body.links.size());
    at_rest.devices.resize(body.devices.size());
  }
  for (HostedController& hosted : controllers_) {
    hosted.delayed = is_delayed(hosted);
    if (!hosted.is_called()) continue;
    for (const std::string& finding : hosted.io->freeze()) event(Severity::warning, hosted.label, finding);
    hosted.reported.odd_outputs.assign(hosted.io->outputs().size, false);
  }
  for (std::size_t i = 0; i < controllers_.size(); ++i) {
    HostedController& hosted = controllers_[i];
    if (!hosted.running) continue;
    set_drives(i, command);
    // Commands to devices in initialize() act before the run, and are recorded with tick 0.
    HostedController& leader = hosted.parent >= 0 ? controllers_[hosted.parent] : hosted;
    for (DeviceOutput& output : leader.io_body->take_device_outputs()) {
      apply_device_output(hosted, output, command);
      output.acted_in_initialize = true;
      leader.early_outputs.push_back(std::move(output));
    }
  }
  read_backs_.find(*scenario_, controllers_);
  if (scenario_->initial_commands) output_of_initialize(command);
  return command;
}

/// As Choreonoid's item of a controller: once, in their order, whatever their delay. External wrenches are lost: every
/// simulator item sets them to zero before the first step.
void ControllerHost::output_of_initialize(Command& command) {
  read_backs_.begin_late_outputs();
  for (std::size_t i = 0; i < controllers_.size(); ++i) {
    if (!controllers_[i].running) continue;
    controllers_[i].io->output();
    apply(i, Timing::next_step, command);
  }
  for (BodyCommand& body : command.bodies) std::ranges::fill(body.external, Wrench());
  read_backs_.clear_wrenches();
}

/// The last controller that commands a joint determines its drive.
void ControllerHost::set_drives(std::size_t index, Command& command) {
  const HostedController& hosted = controllers_[index];
  for (const IoField& field : hosted.io->outputs().fields)
    if (field.quantity <= Quantity::u)
      command.bodies[hosted.body].joints[field.joint].drive = drive_of(hosted.io->mode_of(field.link));
}

/// Tells which joints several running controllers command.
void ControllerHost::tell_shared_joints(std::size_t index) {
  const HostedController& hosted = controllers_[index];
  std::set<int> joints;  // with several quantities a joint has several fields
  for (const IoField& field : hosted.io->outputs().fields) {
    if (field.quantity > Quantity::u || !joints.insert(field.joint).second) continue;
    for (std::size_t other = 0; other < index; ++other) tell_shared_joint(controllers_[other], hosted, field);
  }
}

void ControllerHost::tell_shared_joint(const HostedController& before, const HostedController& hosted,
                                       const IoField& field) {
  if (!before.is_called() || before.body != hosted.body || !before.io->commands_joint(field.joint)) return;
  const std::string& joint = scenario_->bodies[hosted.body].model->links[field.link].joint.name;
  const int mode = hosted.io->mode_of(field.link), mode_before = before.io->mode_of(field.link);
  const bool is_same_number = before.io_body == hosted.io_body;  // of one body, which a child shares with its parent
  if (mode == mode_before && (is_same_number || drive_of(mode) == drive_none)) return;
  if (mode == mode_before)
    event(Severity::warning, hosted.label,
          fmt::format("commands joint '{}' by {}, as '{}' does: of a tick the command of '{}' acts", joint,
                      joint_mode_names(mode), before.label, hosted.label));
  else
    event(Severity::warning, hosted.label,
          fmt::format("commands joint '{}' by {}, which '{}' commands by {}: it is driven as '{}' says", joint,
                      joint_mode_names(mode), before.label, joint_mode_names(mode_before), hosted.label));
}

void ControllerHost::start() {
  for (HostedController& hosted : controllers_) {
    if (!hosted.running || failure_) continue;
    bool accepted = false;
    if (call(hosted, "start", [&] { accepted = hosted.controller->start(); }) && !accepted) refuse(hosted, "start");
  }
  for (std::size_t i = 0; i < controllers_.size(); ++i)
    if (controllers_[i].is_called()) tell_shared_joints(i);
  unread_inputs_.begin(controllers_);
}

}  // namespace rehearse
