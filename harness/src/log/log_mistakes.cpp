#include "log_mistakes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include "log_commands.h"
#include "model/names.h"

namespace rehearse {
namespace {

/// The first names, for a message.
std::string list_of(std::vector<std::string> names) {
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
    if (found.names.count(name) == 0)
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
    if (is_new) continue;
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
  return names.empty() ? "no joint of the model" : list_of(names);
}

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
                                                                        sources[i].source->topic, list_of(joints)),
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
  const std::string list = list_of(missing);
  if (missing.size() == commanded.size())
    return at(source.place, error(fmt::format("nothing can be compared: the controller commands {}, and '{}' has {}",
                                              list, source.topic, quantities_of(survey, model)),
                                  "look at its joints, names and quantity"));
  Diagnostic& remark = remarks.emplace_back(
      at(source.place, error(fmt::format("{} of {} commanded numbers aren't compared: '{}' has no {}", missing.size(),
                                         commanded.size(), source.topic, list),
                             "look at its joints and names")));
  remark.severity = Severity::warning;
  return {};
}

}  // namespace rehearse
