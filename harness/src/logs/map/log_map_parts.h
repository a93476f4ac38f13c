// The reader of a map's parts, which checks each against the model and the log's topics.
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bound_map_forms.h"
#include "core/kinds/kinds.h"
#include "log_map.h"

namespace rehearse {

inline constexpr std::string_view name_of_topic = "the name of one of the log's topics";
/// The default of max_age [s]. Pictures and scans have a longer one, and a joystick none: it sends when it is moved.
inline constexpr double max_age_of_numbers = 0.1;

/// False for distances and figures of a camera: their topics are keys of the source of its pictures.
inline bool has_own_sources(const LogInput& input) {
  return input.content != LogInput::Content::depth && input.content != LogInput::Content::camera_info;
}

/// The reader of one map file.
class LogMapReader {
 public:
  LogMapReader(Findings& findings, const Model& model, const std::vector<LogTopic>& topics, LogMap& map)
      : findings_(findings), model_(model), topics_(topics), map_(map) {}

  void read(const YamlNode& root);

 private:
  /// Alternative sets of fields. A topic must have all fields of one set.
  using Needs = std::vector<std::pair<std::string, FieldContent>>;

  // log_map.cpp
  bool check_version(const YamlNode& root);
  void read_body(const Keys& keys, const YamlNode& root);
  void read_tick(const YamlNode& node);
  void read_start(const Keys& keys);
  void read_missing(const Keys& keys);
  bool has_topic(const std::string& topic) const;
  void read_restarts(const YamlNode& node);
  void read_renamed(const YamlNode& node);
  bool rename_joint(const NamedEntry& entry, const std::string& later);
  void read_limits(const YamlNode& node);
  void read_controller(const YamlNode& node);
  void check_something_is_mapped(const YamlNode& root);

  // log_map_sources.cpp
  /// A single source or a list of them; `read` is called with each.
  template <class Read>
  void each(const YamlNode& node, std::string_view label, Read&& read) {
    if (node.kind != YamlNode::Kind::list) return read(node);
    if (node.items.empty())
      findings_.error(node, std::string(label) + " is an empty list", "expected at least one source, or no such key");
    for (const YamlNodePtr& item : read_list(findings_, node, label, "a list of sources")) read(*item);
  }
  /// The topic of that name that has one of the sets of fields; null, and an error is reported, if there is none.
  const LogTopic* find_topic(const YamlNode& node, std::string_view label, const std::vector<Needs>& needs,
                             std::string_view what, LogSource& source);
  /// The keys of a source; none if the source is a topic alone.
  std::optional<Keys> keys_of(const YamlNode& node, const Form& form);
  /// The bound keys of a source. A clock that the source lacks is the map's, and so is its max_age, unless its default
  /// is nullopt. Null keys: the source is a topic alone.
  template <class Source>
  void read_source(const BoundForm<Source>& form, const Keys* keys, Source& source, std::optional<double> max_age) {
    source.clock = clock_;
    if (max_age) source.max_age = max_age_ ? max_age_ : max_age;
    if (keys == nullptr) return;
    form.read(*keys, source);
    if (const YamlNode* offset = keys->find("clock_offset"); offset && source.clock == LogClock::log_time)
      findings_.error(*offset, "'clock_offset' without stamps", "expected clock: header.stamp, too");
  }
  void check_clock(const YamlNode& node, const LogTopic& topic, const LogSource& source);
  void read_names(const YamlNode& node, std::map<std::string, JointRename>& names);
  std::optional<int> read_joint(const YamlNode& node);
  void read_joints(const YamlNode& node);
  void read_root(const YamlNode& node);
  /// The fields x, y and z of two vectors.
  static Needs two_vectors(std::string_view one, std::string_view other);
  static Needs twist() { return two_vectors("linear", "angular"); }
  static Needs twist_stamped() { return two_vectors("twist/linear", "twist/angular"); }
  void read_joystick(const YamlNode& node);
  void read_axes(const YamlNode& node, JoySource& source);
  void read_buttons(const YamlNode& node, JoySource& source);
  void read_commands(const YamlNode& node);
  void read_state(const YamlNode& node);
  void read_array_commands(const Keys& keys, CommandSource& source);

  // log_map_devices.cpp
  void read_device_source(const YamlNode& node, const LogInput& input);
  void read_numbers_source(const YamlNode& node, const LogInput& input);
  void read_camera(const YamlNode& node);
  void read_ranges(const YamlNode& node, const LogInput& input);
  void read_sensor(const Keys& keys, DeviceSource source, const std::vector<Needs>& needs);
  std::vector<int> read_devices(const Keys& keys, const LogInput& input);
  void read_device(const YamlNode& node, const LogInput& input, std::vector<int>& devices);

  Findings& findings_;
  const Model& model_;
  const std::vector<LogTopic>& topics_;
  LogMap& map_;
  LogClock clock_ = LogClock::log_time;                            // of all sources without their own
  std::optional<double> max_age_;                                  // stated in the map for all sources [s]
  std::map<std::string, std::pair<LogClock, int>> clocks_;         // by topic, with the line of its first source
  std::set<std::string> joint_topics_;                             // joint topics read so far
  std::map<std::pair<int, LogInput::Content>, int> device_lines_;  // lines that already named a device
};

}  // namespace rehearse
