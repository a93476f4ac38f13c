// For any bytes, the reader of maps returns a map, or errors with their places, and never crashes or hangs. A returned
// map names only parts that the model and the log have.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "../harness/log/mapped_robot.h"
#include "logs/map/log_map.h"

using namespace rehearse;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

bool is_device(const Model& model, int device) {
  return device >= 0 && static_cast<std::size_t>(device) < model.devices.size();
}

bool is_joint(const Model& model, int joint) {
  return joint >= 0 && static_cast<std::size_t>(joint) < model.joints.size();
}

bool is_topic(const std::vector<LogTopic>& topics, const LogSource& source) {
  for (const LogTopic& topic : topics)
    if (topic.name == source.topic) return topic.problem.empty();
  return false;
}

void check(const LogMap& map, const Model& model, const std::vector<LogTopic>& topics) {
  require(!map.body.empty());
  require(map.time_step >= Scenario::min_time_step && map.time_step <= Scenario::max_time_step);
  require(!map.joints.empty() || !map.devices.empty() || map.joystick || map.root);
  const auto check_names = [&model](const std::map<std::string, JointRename>& names) {
    for (const auto& [name, rename] : names) require(is_joint(model, rename.joint) && rename.scale != 0.0);
  };
  for (const JointSource& source : map.joints) {
    require(is_topic(topics, source));
    check_names(source.names);
  }
  for (const DeviceSource& source : map.devices) {
    require(is_topic(topics, source) && !source.devices.empty());
    for (const int device : source.devices) require(is_device(model, device));
  }
  if (map.joystick) require(is_topic(topics, *map.joystick));
  if (map.root) require(is_topic(topics, *map.root));
  if (!map.commands) return;
  require(is_topic(topics, *map.commands));
  check_names(map.commands->names);
  for (const std::optional<int>& joint : map.commands->joints) require(!joint || is_joint(model, *joint));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Model model = mapped_robot();
  static const std::vector<LogTopic> topics = mapped_topics();
  const auto map = LogMap::parse({reinterpret_cast<const char*>(data), size}, "fuzz.yaml", model, topics);
  if (map) {
    check(*map, model, topics);
  } else {
    for (const Diagnostic& diagnostic : map.errors()) require(!diagnostic.message.empty() && diagnostic.line >= 0);
  }
  return 0;
}
