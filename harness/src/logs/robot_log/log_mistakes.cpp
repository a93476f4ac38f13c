#include "log_mistakes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "base/names.h"
#include "log_commands.h"

namespace rehearse {
namespace {

/// The first names, for a message.
std::string first_names(std::vector<std::string> names) {
  constexpr std::size_t most = 6;
  if (names.size() > most) names.resize(most), names.emplace_back("...");
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The place in the map that gives a log's name to a joint: that of the name, else that of the topic.
const Place& place_of(const MappedSource& mapped, const std::string& name) {
  const auto& renamed = mapped.joints ? mapped.joints->names : mapped.commands->names;
  const auto found = renamed.find(name);
  return found == renamed.end() ? mapped.source->place : found->second.place;
}

void check_names(const MappedSource& mapped, const SourceSurvey& found, const Model& model, Diagnostics& mistakes) {
  const auto& renamed = mapped.joints ? mapped.joints->names : mapped.commands->names;
  std::vector<std::string> occurring;
  for (const auto& [name, joint] : found.names) occurring.push_back(name);
  for (const auto& [name, rename] : renamed)
    if (found.names.count(name) == 0 && !rename.is_later)
      mistakes.push_back(
          at(rename.place, error(fmt::format("no message on '{}' names '{}'", mapped.source->topic, name),
                                 name_hint(name, occurring, "names in it"))));
  for (const std::string& name : found.repeated)
    if (found.names.at(name) >= 0)
      mistakes.push_back(at(place_of(mapped, name),
                            error(fmt::format("a message on '{}' names '{}' twice", mapped.source->topic, name),
                                  "a joint has one value in a message")));
  std::map<int, std::string> taken;
  for (const auto& [name, joint] : found.names) {
    if (joint < 0) continue;
    const auto [first, is_new] = taken.emplace(joint, name);
    const auto is_later = [&](const std::string& one) { return renamed.contains(one) && renamed.at(one).is_later; };
    if (is_new || is_later(name) || is_later(first->second)) continue;
    const bool is_renamed = renamed.count(name) > 0;
    mistakes.push_back(at(place_of(mapped, is_renamed ? name : first->second),
                          error(fmt::format("'{}' and '{}' on '{}' are the same joint, {}", first->second, name,
                                            mapped.source->topic, model.links[model.joints[joint]].joint.name),
                                "expected one name of the log for a joint")));
  }
}

/// The commands of a log in words: "HIP/u, KNEE/u".
std::string quantities_of(const SourceSurvey& survey, const Model& model) {
  std::vector<std::string> names;
  for (const auto& [joint, given] : survey.joints) {
    const std::string& name = model.links[model.joints[joint]].joint.name;
    if (given.q) names.push_back(name + "/q");
    if (given.dq) names.push_back(name + "/dq");
    if (given.u) names.push_back(name + "/u");
  }
  return names.empty() ? "no joint of the model" : first_names(names);
}

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
    missing_.push_back(error_in(map_.file,
                                fmt::format("controller '{}' reads {}, which has no source in the map", label_, what),
                                std::move(hint)));
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
    const LogInput* input = log_input_of(device);
    if (!input) return;  // it measures nothing
    for (const DeviceSource& source : map_.devices)
      if (source.input->content != LogInput::Content::camera_info &&
          std::ranges::find(source.devices, index) != source.devices.end())
        return;
    miss(fmt::format("device '{}'", device.name),
         fmt::format("{}: {{topic: ..., device: {}}} would give it", input->key, device.name));
  }

  const Model& model_;
  const LogMap& map_;
  std::map<int, GivenJoint> joints_;  // by id
  std::set<std::string> strangers_;
  std::string label_;
  Diagnostics missing_;
};

}  // namespace

Diagnostics mistakes_in_names(const std::vector<MappedSource>& sources, const LogSurvey& survey, const Model& model) {
  Diagnostics mistakes;
  std::map<std::pair<int, int>, std::string> taken;  // topics by joint and quantity
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const SourceSurvey& found = survey.sources[i];
    if (!sources[i].joints && !sources[i].commands) continue;
    if (sources[i].commands && found.unreadable)
      mistakes.push_back(
          at(sources[i].source->place, error(fmt::format("no message on '{}' can be read: the first has {}",
                                                         sources[i].source->topic, found.unreadable->message),
                                             found.unreadable->hint)));
    if (!found.names.empty()) check_names(sources[i], found, model, mistakes);
    if (!sources[i].joints) continue;
    std::map<std::string, std::vector<std::string>> shared;  // joints by the topic that has them, too
    for (const auto& [joint, given] : found.joints) {
      const std::array<bool, 3> quantities{given.q, given.dq, given.u};
      for (int quantity = 0; quantity < 3; ++quantity) {
        if (!quantities[quantity]) continue;
        const auto [first, is_new] = taken.emplace(std::pair(joint, quantity), sources[i].source->topic);
        if (is_new) continue;
        shared[first->second].push_back(model.links[model.joints[joint]].joint.name);
        break;
      }
    }
    for (const auto& [topic, joints] : shared)
      mistakes.push_back(at(sources[i].source->place, error(fmt::format("'{}' and '{}' both have {}", topic,
                                                                        sources[i].source->topic, first_names(joints)),
                                                            "expected one source for a joint")));
  }
  return mistakes;
}

Result<void> check_commands(const ControllerHost& host, const Model& model, const CommandSource& source,
                            const SourceSurvey& survey, Diagnostics& remarks) {
  std::vector<std::string> commanded, missing;
  for (const HostedController& hosted : host.controllers()) {
    if (!hosted.running) continue;
    for (const IoField& field : hosted.io->outputs().fields) {
      if (!commanded_part(field)) continue;
      const auto given = survey.joints.find(field.joint);
      const std::string name = fmt::format("{}/{}", model.links[field.link].joint.name, name_of(field.quantity));
      commanded.push_back(name);
      const bool is_given = given != survey.joints.end() && (field.quantity == Quantity::q    ? given->second.q
                                                             : field.quantity == Quantity::dq ? given->second.dq
                                                                                              : given->second.u);
      if (!is_given) missing.push_back(name);
    }
  }
  if (commanded.empty())
    return at(source.place, error("nothing can be compared: the controller commands no joint", "take commands out"));
  if (missing.empty()) return {};
  const std::string list = first_names(missing);
  if (missing.size() == commanded.size())
    return at(source.place, error(fmt::format("nothing can be compared: the controller commands {}, and '{}' has {}",
                                              list, source.topic, quantities_of(survey, model)),
                                  "look at its joints, names and quantity"));
  remarks.push_back(at(source.place, warning(fmt::format("{} of {} commanded numbers aren't compared: '{}' has no {}",
                                                         missing.size(), commanded.size(), source.topic, list),
                                             "look at its joints and names")));
  return {};
}

Diagnostics inputs_not_given(const ControllerHost& host, const Model& model, const LogMap& map,
                             const std::vector<MappedSource>& sources, const LogSurvey& survey) {
  Requirements requirements(model, map, sources, survey);
  for (const HostedController& hosted : host.controllers())
    if (hosted.running) requirements.check(hosted);
  return requirements.take();
}

}  // namespace rehearse
