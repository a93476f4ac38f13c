#include "replay_conditions.h"

#include <fmt/format.h>

#include <set>
#include <string_view>

#include "core/guard/opened_files.h"
#include "core/host/virtualised.h"
#include "core/kinds/channel_name.h"
#include "core/recording/provenance.h"
#include "core/recording/recorder.h"
#include "core/trace/run_facts.h"
#include "recording_source.h"

namespace rehearse {

Diagnostics unrecorded_inputs(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host,
                              const RecordedInputs& inputs) {
  Diagnostics missing;
  if (scenario.joystick && !inputs.has_joystick())
    missing.push_back(
        in_recording(recording, error("the run has a joystick, but its input was not recorded: there is no /joy",
                                      "record the scenario again")));
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.running) continue;
    const Model& model = *scenario.bodies[hosted.body].model;
    const auto report = [&](const std::string& what) {
      missing.push_back(in_recording(
          recording, error(fmt::format("controller '{}' reads {}, which was not recorded", hosted.label, what),
                           "record again with this controller")));
    };
    for (const IoField& field : hosted.io->inputs().fields)
      if (!inputs.has(hosted.body, field))
        report(fmt::format("{} of link '{}'", name_of(field.quantity), model.links[field.link].name));
    for (const int link : hosted.io->contact_links())
      if (!inputs.has_contacts(hosted.body, link))
        report(fmt::format("the contact points of link '{}'", model.links[link].name));
    for (const int device : hosted.io->input_devices()) {
      const DeviceKind& kind = model.devices[device].kind;
      const bool is_still_camera = std::holds_alternative<Camera>(kind) &&
                                   !scenario.runs_camera(scenario.bodies[hosted.body].name, model.devices[device].name);
      const bool said_nothing = is_still_camera || std::holds_alternative<Light>(kind);
      if (!said_nothing && !inputs.has_device(hosted.body, device))
        report(fmt::format("device '{}'", model.devices[device].name));
    }
  }
  return missing;
}

std::vector<std::string> other_controllers(const mcap::Reader& recording, const ControllerHost& host) {
  const RunFacts recorded = RunFacts::of(recording);
  std::vector<std::string> others;
  for (const HostedController& hosted : host.controllers())
    if (!recorded.had_library(hosted.label, hosted.library->content_hash())) others.push_back(hosted.label);
  return others;
}

namespace {

/// A channel of inputs, except those of joints, whose values are listed one by one.
void add_channel(const std::string& topic, std::set<std::string>& inputs) {
  const ChannelName name = ChannelName::parse(topic);
  if (name.side == ChannelSide::input && !is_joint_input(name)) inputs.insert(topic);
}

/// The values of joints that controllers read now, as RecordedInputs::joints_read().
std::set<std::string> joints_read(const Scenario& scenario, const ControllerHost& host) {
  std::set<std::string> values;
  for (const HostedController& hosted : host.controllers()) {
    const Model& model = *scenario.bodies[hosted.body].model;
    for (const IoField& field : hosted.io->inputs().fields)
      if (field.quantity <= Quantity::u)
        values.insert(fmt::format("{}/{} of {}", model.links[model.joints[field.joint]].joint.name,
                                  name_of(field.quantity), hosted.label));
  }
  return values;
}

}  // namespace

std::vector<std::string> other_inputs(const mcap::Reader& recording, const Scenario& scenario,
                                      const ControllerHost& host, const RecordedInputs& inputs) {
  std::set<std::string> recorded = inputs.joints_read(), here = joints_read(scenario, host);
  for (const auto& [topic, metadata] : Recorder::channels_of(scenario, host)) add_channel(topic, here);
  for (const auto& [id, channel] : recording.channels()) add_channel(channel.topic, recorded);
  if (const auto devices = RunFacts::of(recording).devices_read) {
    for (const auto& [device, controllers] : *devices) recorded.insert(device);
    for (const HostedController& hosted : host.controllers()) {
      const ScenarioBody& body = scenario.bodies[hosted.body];
      for (const int device : hosted.io->input_devices())
        here.insert(body.name + "/" + body.model->devices[device].name);
    }
  }
  std::vector<std::string> others;
  for (const std::string& input : recorded)
    if (!here.contains(input)) others.push_back("- " + input);
  for (const std::string& input : here)
    if (!recorded.contains(input)) others.push_back("+ " + input);
  return others;
}

bool has_channels_of(const mcap::Reader& recording, const Scenario& scenario, const ControllerHost& host) {
  std::map<std::string, mcap::StringMap> here = Recorder::channels_of(scenario, host), there;
  const auto is_of_side = [](const ChannelName& name) {
    return name.side == ChannelSide::input || name.side == ChannelSide::output;
  };
  std::erase_if(here, [&](const auto& entry) { return !is_of_side(ChannelName::parse(entry.first)); });
  for (const auto& [id, channel] : recording.channels()) {
    const ChannelName name = ChannelName::parse(channel.topic);
    // channels of a device's commands and of a changed delay are added by their first message
    if (!is_of_side(name) || name.kind == ChannelKind::device_state || name.kind == ChannelKind::delay) continue;
    there[channel.topic] = channel.metadata;
    there[channel.topic].erase("offered_qos_profiles");  // added by the writer
  }
  return here == there;
}

/// If a failure ended the run, the files that it would have read later are unknown. Recordings from before files were
/// recorded don't contain the content of files.
std::vector<std::string> changed_files(const mcap::Reader& recording, const ControllerHost& host) {
  const RunFacts facts = RunFacts::of(recording);
  if (facts.is_of_flight) return {};  // nobody saw what the robot's loop read
  const std::optional<mcap::StringMap>& recorded = facts.files;
  std::vector<std::string> changes;
  for (const auto& [file, content] : host.files_read()) {
    const auto before = recorded ? recorded->find(file) : mcap::StringMap::const_iterator();
    const bool is_known = recorded && before != recorded->end();
    if (is_known && before->second == content) continue;
    const bool is_library = file.find(std::string(": ") + linked_library_prefix) != std::string::npos;
    if (is_library && !is_known) continue;  // older recordings don't state it
    if (content == missing_file)
      changes.push_back(fmt::format("{} wasn't found", file));
    else if (is_known)
      changes.push_back(fmt::format("{} has changed since the recording", file));
    else
      changes.push_back(fmt::format("{} is read, but the recording doesn't state its content", file));
  }
  return changes;
}

Diagnostics other_arithmetic_than(const mcap::Reader& recording, const Scenario& scenario) {
  const auto recorded = RunFacts::of(recording).provenance;
  if (!recorded) return {};
  const std::string other = other_arithmetic(*recorded, provenance(scenario, nullptr, "", ""));
  if (other.empty()) return {};
  return {error(fmt::format("this process may round differently than the process that recorded: {}", other),
                "last bits may differ for this reason alone; rehearse check compares within tolerance then")};
}

Diagnostics other_clock_than(const mcap::Reader& recording) {
  if (!virtualised_seed(recording) || !virtualisation().empty()) return {};
  return {in_recording(
      recording, error("its controllers got simulated time and seeded random numbers, but here they get the system's: "
                       "their commands may differ for this reason",
                       "rehearse replay gives them simulated time and seeded numbers"))};
}

}  // namespace rehearse
