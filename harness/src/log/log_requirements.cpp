#include "log_requirements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "model/names.h"

namespace rehearse {
namespace {

class Requirements {
 public:
  Requirements(const Model& model, const LogMap& map, const std::vector<MappedSource>& sources, const LogSurvey& survey)
      : model_(model), map_(map) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (!sources[i].joints) continue;
      for (const auto& [joint, given] : survey.sources[i].joints) {
        GivenJoint& all = joints_[joint];
        all.q |= given.q;
        all.dq |= given.dq;
        all.u |= given.u;
      }
      for (const auto& [name, joint] : survey.sources[i].names)
        if (joint < 0) strangers_.insert(name);
    }
  }

  void check(const HostedController& hosted) {
    label_ = hosted.label;
    for (const IoField& field : hosted.io->inputs().fields) check_field(field);
    for (const int link : hosted.io->contact_links())
      miss(fmt::format("the contact points of link '{}'", model_.links[link].name), "no message of a log has them");
    for (const int device : hosted.io->input_devices()) check_device(model_.devices[device], device);
  }

  Diagnostics take() { return std::move(missing_); }

 private:
  void miss(const std::string& what, std::string hint) {
    Diagnostic finding =
        error(fmt::format("controller '{}' reads {}, which has no source in the map", label_, what), std::move(hint));
    finding.file = map_.file;
    missing_.push_back(std::move(finding));
  }

  void check_field(const IoField& field) {
    const Link& link = model_.links[field.link];
    switch (field.quantity) {
      case Quantity::q:
      case Quantity::dq:
      case Quantity::u: return check_joint(field, link);
      case Quantity::ddq: return miss(fmt::format("ddq of joint '{}'", link.joint.name), "no message of a log has it");
      case Quantity::pose:
        if (!map_.root && model_.links[0].joint.type == JointType::free)
          miss(fmt::format("T of link '{}'", link.name), "root: the topic of a PoseStamped or Odometry would give it");
        return;
      case Quantity::twist:
        if (field.link != 0 || !map_.root || !map_.root->has_twist)
          miss(fmt::format("v, w of link '{}'", link.name), field.link == 0
                                                                ? "root: the topic of an Odometry would give it"
                                                                : "a log gives it of the root link alone");
        return;
      case Quantity::acceleration:
        return miss(fmt::format("dv, dw of link '{}'", link.name), "no message of a log has it");
      case Quantity::wrench: return;  // always zero
    }
  }

  void check_joint(const IoField& field, const Link& link) {
    const GivenJoint given = joints_.count(field.joint) ? joints_.at(field.joint) : GivenJoint();
    const bool is_given = field.quantity == Quantity::q ? given.q : field.quantity == Quantity::dq ? given.dq : given.u;
    if (is_given) return;
    const std::string what = fmt::format("{} of joint '{}'", name_of(field.quantity), link.joint.name);
    if (map_.joints.empty()) return miss(what, "joints: the topic of a JointState would give it");
    if (field.quantity == Quantity::dq && given.q)
      return miss(what, "the messages have no velocity; velocity: differentiate would compute it from the positions");
    if (given.q || given.dq || given.u) return miss(what, "the messages have no such values of it");
    const std::vector<std::string> names(strangers_.begin(), strangers_.end());
    const std::vector<std::string> near = near_names(link.joint.name, names);
    if (!near.empty()) return miss(what, fmt::format("names: {{{}: {}}} would give it", near[0], link.joint.name));
    if (names.empty()) return miss(what, "no message names it");
    constexpr std::size_t most = 8;
    const auto shown = names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), most));
    miss(what, fmt::format("no message names it; not in the model are {}{}", fmt::join(names.begin(), shown, ", "),
                           names.size() > most ? ", ..." : ""));
  }

  void check_device(const Device& device, int index) {
    if (is_actuator(device)) return;  // it measures nothing
    for (const DeviceSource& source : map_.devices)
      if (source.kind != DeviceSource::Kind::camera_info &&
          std::find(source.devices.begin(), source.devices.end(), index) != source.devices.end())
        return;
    const char* key = "imus";
    if (std::holds_alternative<ForceSensor>(device.kind)) key = "wrenches";
    if (std::holds_alternative<Camera>(device.kind)) key = "cameras";
    if (std::holds_alternative<RangeSensor>(device.kind)) key = "ranges";
    const bool never = std::holds_alternative<ContactSensor>(device.kind);
    miss(fmt::format("device '{}'", device.name),
         never ? "no message of a log has its measurements"
               : fmt::format("{}: {{topic: ..., device: {}}} would give it", key, device.name));
  }

  const Model& model_;
  const LogMap& map_;
  std::map<int, GivenJoint> joints_;  // by id
  std::set<std::string> strangers_;
  std::string label_;
  Diagnostics missing_;
};

}  // namespace

Diagnostics inputs_not_given(const ControllerHost& host, const Model& model, const LogMap& map,
                             const std::vector<MappedSource>& sources, const LogSurvey& survey) {
  Requirements requirements(model, map, sources, survey);
  for (const HostedController& hosted : host.controllers())
    if (hosted.running) requirements.check(hosted);
  return requirements.take();
}

mcap::StringMap metadata_of(const LogTopicReport& topic) {
  std::vector<std::string> reasons, silent;
  for (const LogUnreadable& found : topic.unreadable_for)
    reasons.push_back(fmt::format("{} from {:.9g} s on: {}", found.messages, found.first_at, found.reason));
  for (const SilentJoint& joint : topic.silent_joints)
    silent.push_back(fmt::format("{}: {} gaps, {} ticks", joint.joint, joint.gaps, joint.ticks_in_gaps));
  return {{"unreadable_for", fmt::format("{}", fmt::join(reasons, "; "))},
          {"silent_joints", fmt::format("{}", fmt::join(silent, "; "))},
          {"use", topic.use},
          {"type", topic.type},
          {"messages", fmt::format("{}", topic.messages)},
          {"used", fmt::format("{}", topic.used)},
          {"skipped", fmt::format("{}", topic.skipped)},
          {"out_of_order", fmt::format("{}", topic.out_of_order)},
          {"same_stamp", fmt::format("{}", topic.same_stamp)},
          {"backwards", fmt::format("{}", topic.backwards)},
          {"unreadable", fmt::format("{}", topic.unreadable)},
          {"rate", fmt::format("{:.6g} Hz", topic.rate)},
          {"longest_gap", fmt::format("{:.9g} s from {:.9g} s on", topic.longest_gap, topic.longest_gap_at)},
          {"worst_age", fmt::format("{:.9g} s at {:.9g} s", topic.worst_age, topic.worst_age_at)},
          {"gaps", fmt::format("{}", topic.gaps)},
          {"ticks_in_gaps", fmt::format("{}", topic.ticks_in_gaps)},
          {"ticks_without", fmt::format("{}", topic.ticks_without)}};
}

}  // namespace rehearse
