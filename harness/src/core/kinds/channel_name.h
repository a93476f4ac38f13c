// The parts of the name of a channel (its topic). No other code parses topics.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinds.h"

namespace rehearse {

/// The owner of the values: the simulated body, or one of the sides of a controller.
enum class ChannelSide : std::uint8_t {
  none,
  input,
  output,
  acted,  // in a branch: the source's commands, which moved the world before the branch began
  variable,
};

/// The parts of a topic: "/tick", "/BODY/joints", "/BODY/OWNER/pose", "/BODY/CONTROLLER/input/joints",
/// "/BODY/CONTROLLER/output/OWNER/pose", "/BODY/CONTROLLER/variable/OWNER".
struct ChannelName {
  std::string body = {};                 // empty: the channel of the whole run
  std::string controller = {};           // empty: a channel of the body itself
  ChannelSide side = ChannelSide::none;  // side of the controller
  std::string owner = {};                // link, device or variable, which may have a '/' in its name; may be empty
  ChannelKind kind = ChannelKind::other;
  std::string foreign = {};  // only for kind `other`: the whole topic

  static ChannelName parse(std::string_view topic);
  static ChannelName of_run(ChannelKind kind);
  static ChannelName of_body(std::string body, ChannelKind kind);
  static ChannelName of_owner(std::string body, std::string owner, ChannelKind kind);
  /// `label`: "BODY/CONTROLLER", as HostedController has it.
  static ChannelName of_controller(std::string_view label, ChannelSide side, ChannelKind kind, std::string owner = {});
  static ChannelName of_variable(std::string_view label, std::string name);

  /// The topic, which parse() can read; '/' in an owner is written %2F, and '%' is written %25.
  std::string topic() const;
  /// "BODY/CONTROLLER"; empty: the channel isn't a controller's.
  std::string label() const;
  bool is_of(std::string_view controller_label, ChannelSide of_side) const {
    return side == of_side && label() == controller_label;
  }

  /// True for the channel of a link; false for channels of devices and of all joints.
  bool is_of_link() const;

  bool operator==(const ChannelName&) const = default;
};

/// True for the joints that a controller reads.
inline bool is_joint_input(const ChannelName& name) {
  return name.side == ChannelSide::input &&
         (name.kind == ChannelKind::joints || name.kind == ChannelKind::joint_accelerations);
}

/// The topics of the whole run, and the part that occurs in all topics and series of variables, and in no others.
namespace run_topics {
inline constexpr const char* tick = "/tick";
inline constexpr const char* transforms = "/tf";
inline constexpr const char* events = "/events";
inline constexpr const char* contact_changes = "/contacts";
inline constexpr const char* checkpoint = "/checkpoint";
inline constexpr const char* variable_part = "/variable/";
inline constexpr const char* output_part = "/output/";  // of a controller's commands
}  // namespace run_topics

/// An owner's name as a segment of a topic or of a series: '/' is written %2F, and '%' is written %25.
std::string topic_segment(std::string_view name);

/// The name of a series in a trace: the topic without its first slash and its last segment, then the element.
std::string series_name(std::string_view topic, std::string_view element);

/// The segment by which channels of one kind differ, as written in the topic: the owner's, else the body's. For topics
/// of other programs it is the last but one. Empty: the topic is the only one of its kind.
std::string_view distinguishing_segment(std::string_view topic);

/// The body at the beginning of a series, a frame or a link's full name: "SR1" of "SR1/WAIST"; empty: there is no '/'.
std::string_view body_of_name(std::string_view name);

/// False if no series of a recorded channel matches the pattern, whatever values its messages have.
bool may_match(std::string_view topic, std::string_view pattern);

/// The unit of a joint's "q", "dq", "ddq" or "u".
std::string_view unit_of_joint(std::string_view quantity, bool linear);

/// The `unit:` metadata of a channel of that kind; empty for joints, because their units depend on the joints.
mcap::StringMap unit_metadata(ChannelKind kind);

/// The chunks of a channel's messages. The messages of a stage share chunks: a replay reads the chunks of the
/// controllers, and needn't decompress the state of the world.
mcap::ChunkGroup chunk_group_of(const ChannelName& name);

/// The unit that a channel's metadata states for an element: for the element alone, for one of its name's segments, or
/// for the whole channel; empty: none is stated.
std::string unit_of(const mcap::StringMap& metadata, std::string_view element);

/// The stage that makes an element's value. The hashes and results in /tick have different stages. For a topic of
/// another program the last segment decides.
Stage stage_of(const ChannelName& name, std::string_view element = {});
Stage stage_of(std::string_view topic, std::string_view element = {});

}  // namespace rehearse
