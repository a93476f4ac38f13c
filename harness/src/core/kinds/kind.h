// ChannelForm: everything that recorder, reader, replay, comparison and exports know of the messages of a kind.
//
// A kind is one file of this folder, NAME.cpp, which defines NAME_kind, and a row of kinds.inl. A sensor's kind also
// has a DeviceMeasurement: how readings become messages, messages become readings, and readings reach a controller.
#pragma once

#include <rehearse/cdr.h>
#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>
#include <rehearse/trace_table.h>
#include <rehearse/units.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cnoid {
class Device;
}

namespace rehearse {

class RowReader;

/// Numbers of a message that share a name and a unit.
struct ElementGroup {
  std::string_view name;  // "position"; empty: the whole message
  UnitName unit;          // may be empty; for a quantity of joints the unit of a rotational joint
  /// "xyz": the elements are position/x, position/y, position/z; empty: one element or an array.
  std::string_view axes = {};
  UnitName linear_unit = {};  // unit of a prismatic joint
};

/// The encoding of messages that are a header and a fixed number of numbers, in the order of the kind's elements.
struct NumberMessage {
  void (*encode)(const msg::Header& header, std::span<const double> numbers, CdrWriter& cdr);
  /// False if the bytes are no such message.
  bool (*decode)(mcap::Bytes message, std::vector<double>& numbers);
};

/// A measurement as a message that isn't written so far.
struct DeviceMessage {
  CdrWriter cdr;  // the message, unless it is composed later
  // For a message that takes long to compose:
  mcap::Compose compose = nullptr;
  std::vector<std::byte> raw;  // its argument
  std::size_t held = 0;        // size by which the message counts until it is composed [bytes]
};

/// The frame of a device's messages, if it isn't the device frame.
struct MessageFrame {
  std::string_view suffix;    // of its name, behind BODY/DEVICE
  Eigen::Matrix3d (*axes)();  // rotation from this frame to the device frame
};

/// The messages of a robot's log that feed devices: their key in a map, and the words of its mistakes.
struct LogInput {
  enum class Content : std::uint8_t { none, numbers, picture, depth, camera_info, ranges };

  Content content;
  std::string_view key = {};       // "imus"
  std::string_view form = {};      // of numbers: the name of the form of a source: "imu_source"
  std::string_view owner = {};     // of numbers: of its keys, in sentences: "an IMU"
  std::string_view devices = {};   // "gyros, accelerometers and IMUs"
  std::string_view messages = {};  // "an Imu"
  std::string_view fields = {};    // before the elements' names in messages of numbers: "wrench/"; empty: nothing
  bool can_interpolate = true;     // of numbers: values between two messages have a meaning
};
/// Of devices that measure nothing.
inline constexpr LogInput no_log_input{.content = LogInput::Content::none};

/// The readings of a device as messages, and as inputs of a controller.
struct DeviceMeasurement {
  const LogInput& log;  // what a log feeds the device with
  /// True for devices with a channel of this kind, of those in the row of kinds.inl. Null: for all of them.
  bool (*is_of)(const Device& device) = nullptr;
  const MessageFrame* frame = nullptr;  // null: the device frame
  bool has_capture_time = false;        // messages are stamped with the time of the capture, not of the tick
  /// Makes the message of a reading. False: the reading has none. Null: that of ChannelForm::numbers.
  bool (*encode)(const Device& device, const DeviceReading& reading, const msg::Header& header,
                 DeviceMessage& message) = nullptr;
  /// Sets the measured values. False: the bytes are no measurement of the device. Fails if a picture can't be decoded.
  /// Null: that of ChannelForm::numbers, or none if that is null, too.
  Result<bool> (*decode)(const Device& device, mcap::Bytes message, DeviceReading& reading) = nullptr;
  /// Index of the kind's element that is the device's first value. Null: 0.
  std::size_t (*first_element)(const Device& device) = nullptr;
  /// The device for a controller. Null: a ValuesDevice, which a controller reads as any Device. Of the kinds of one
  /// device the first one with a function counts, here and for `feed`.
  cnoid::Device* (*make)(const Device& device) = nullptr;
  /// Gives a reading to the controller's device at time `now` [s]. Null: Device::readState() of the values.
  void (*feed)(cnoid::Device& target, const Device& device, const DeviceReading& reading, double now) = nullptr;
};

struct ChannelForm {
  /// The object that a channel describes: the whole run, a body (or all joints on a controller's side), one link or
  /// device, or a variable.
  enum class Level : std::uint8_t { run, body, owner, variable };
  /// Whether the owner of the values is a link.
  enum class OfLink : std::uint8_t { never, always, on_sides };  // on_sides: only on a side of a controller

  Level level;
  std::string_view segment;  // last segment of the topic
  std::string_view type;     // type of the channel's messages
  std::string (*schema)();   // its definition, as ros2msg
  Stage stage;               // stage that makes the values of a channel without side
  std::span<const ElementGroup> groups = {};

  bool has_fixed_elements = false;  // every message has the same elements: those of `groups`
  bool has_series = true;           // false: pictures, texts and checkpoints
  bool is_state = false;            // of the world or its sensors: a golden may keep samples of it
  OfLink of_link = OfLink::never;
  std::optional<mcap::ChunkGroup> chunks = {};                    // none: those of its stage
  Stage (*stage_of_element)(std::string_view element) = nullptr;  // null: all elements have `stage`

  /// The reader of the channel's table; null: messages are read by their schema.
  std::unique_ptr<RowReader> (*make_rows)(TraceChannel& channel, const std::string& owner) = nullptr;
  bool has_rows_by_topic = false;  // make_rows is for topics of this kind, not for all messages of the type
  const NumberMessage* numbers = nullptr;
  /// Sets what a message says of a link. False if the bytes are no such message. Null: it says nothing that is read.
  bool (*read_link)(mcap::Bytes message, int link, BodyObservation& body) = nullptr;
  const DeviceMeasurement* measurement = nullptr;  // null: not of a device
};

// Each is defined in the file of its name.
#define REHEARSE_KIND(name, ...) extern const ChannelForm name##_kind;
#include "kinds.inl"
#undef REHEARSE_KIND

}  // namespace rehearse
