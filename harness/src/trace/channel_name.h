// The vocabulary of a recording: what the name of a channel (its topic) says, and for each kind of channel which
// message it carries, the names and units of its elements, and the stage that makes its values. Nobody else takes a
// topic apart.
#pragma once

#include <rehearse/mcap_types.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The kind of a channel's messages, as the last segment of its topic states it.
enum class ChannelKind : std::uint8_t {
  tick,
  transforms,
  joystick,
  events,
  contact_changes,
  checkpoint,
  joints,
  measured_joints,
  joint_accelerations,
  pose,
  twist,
  acceleration,
  wrench,
  contacts,
  imu,
  contact,
  scan,
  points,
  image,
  depth,
  camera_info,
  device_state,
  variable,
  other,  // a topic that no recording of ours has
};

/// Whose values they are: the simulated body's, or one of the sides of a controller.
enum class ChannelSide : std::uint8_t {
  none,
  input,
  output,
  acted,  // of a branch: the source's commands, which moved the world before the branch began
  variable,
};

/// The parts of a topic: "/tick", "/BODY/joints", "/BODY/OWNER/pose", "/BODY/CONTROLLER/input/joints",
/// "/BODY/CONTROLLER/output/OWNER/pose", "/BODY/CONTROLLER/variable/OWNER".
struct ChannelName {
  std::string body = {};                 // empty: of the whole run
  std::string controller = {};           // empty: of the body itself
  ChannelSide side = ChannelSide::none;  // of the controller
  std::string owner = {};                // link, device or variable, which may have a '/' in its name; may be empty
  ChannelKind kind = ChannelKind::other;
  std::string foreign = {};  // of kind `other`: the whole topic

  static ChannelName parse(std::string_view topic);
  static ChannelName of_run(ChannelKind kind);
  static ChannelName of_body(std::string body, ChannelKind kind);
  static ChannelName of_owner(std::string body, std::string owner, ChannelKind kind);
  /// `label`: "BODY/CONTROLLER", as HostedController has it.
  static ChannelName of_controller(std::string_view label, ChannelSide side, ChannelKind kind, std::string owner = {});
  static ChannelName of_variable(std::string_view label, std::string name);

  /// The text that parse() reads so; owners' '/' is written %2F, and their '%' is written %25.
  std::string topic() const;
  /// "BODY/CONTROLLER"; empty: of no controller.
  std::string label() const;
  bool is_of(std::string_view controller_label, ChannelSide of_side) const {
    return side == of_side && label() == controller_label;
  }

  /// Of a link, and neither of a device nor of all joints.
  bool is_of_link() const;

  bool operator==(const ChannelName&) const = default;
};

/// The topics of the whole run, and the part that all topics of variables, their series and no others have.
namespace run_topics {
inline constexpr const char* tick = "/tick";
inline constexpr const char* transforms = "/tf";
inline constexpr const char* events = "/events";
inline constexpr const char* contact_changes = "/contacts";
inline constexpr const char* checkpoint = "/checkpoint";
inline constexpr const char* variable_part = "/variable/";
}  // namespace run_topics

/// An owner's name as a segment of a topic or of a series: '/' is written %2F, and '%' is written %25.
std::string topic_segment(std::string_view name);

/// The name of a series in a trace: the topic without its first slash and its last segment, then the element.
std::string series_name(std::string_view topic, std::string_view element);

/// The segment by which channels of one kind differ, as it stands in the topic: the owner's, else the body's; of a
/// topic that isn't ours the one before the last. Empty: the topic is the only one of its kind.
std::string_view distinguishing_segment(std::string_view topic);

/// The body that a series, a frame or a link's full name begins with: "SR1" of "SR1/WAIST"; empty: there is no '/'.
std::string_view body_of_name(std::string_view name);

/// Numbers of a message that share a name and a unit.
struct ElementGroup {
  std::string_view name;       // "position"; empty: all of the message
  std::string_view unit;       // may be empty; of a joint's quantity that of a joint that turns
  std::string_view axes = {};  // "xyz": the elements are position/x, position/y, position/z; empty: one or an array
  std::string_view linear_unit = {};  // of a joint that slides
};

struct ChannelForm {
  ChannelKind kind;
  /// Of what it is in a run: of all, of a body (or of all joints of a controller's side), or of one link or device.
  enum class Level : std::uint8_t { run, body, owner, variable } level;
  std::string_view segment;  // the last of the topic
  std::string_view type;     // of its messages
  Stage stage;               // that makes the values of a channel on no side
  std::span<const ElementGroup> groups = {};
};

/// The row of the table; not of kind `other`.
const ChannelForm& form_of(ChannelKind kind);

/// An element of a message and its unit, which may be empty.
struct ChannelElement {
  std::string name;  // "position/x"
  std::string_view unit;
};

/// The elements of a kind whose messages have always the same: of poses, twists, accelerations, wrenches, IMUs and
/// contact sensors, in the order of the message's fields.
const std::vector<ChannelElement>& elements_of(ChannelKind kind);

/// The unit of a joint's "q", "dq", "ddq" or "u".
std::string_view unit_of_joint(std::string_view quantity, bool linear);

/// The `unit:` metadata of a channel of that kind; of joints nothing, as theirs depends on the joints.
mcap::StringMap unit_metadata(ChannelKind kind);

/// The unit that a channel's metadata states for an element: for it alone, for one of its name's segments, or for the
/// whole channel; empty: for none of them.
std::string unit_of(const mcap::StringMap& metadata, std::string_view element);

/// The stage that makes an element's value. The hashes and results in /tick have each their own. Of a topic that isn't
/// ours the last segment decides.
Stage stage_of(const ChannelName& name, std::string_view element = {});
Stage stage_of(std::string_view topic, std::string_view element = {});

}  // namespace rehearse
