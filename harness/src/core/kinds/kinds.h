// The list of all kinds of channels.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kind.h"

namespace rehearse {

/// The kind of a channel's messages, as the last segment of its topic states it.
enum class ChannelKind : std::uint8_t {
#define REHEARSE_KIND(name, ...) name,
#include "kinds.inl"
#undef REHEARSE_KIND
  other,  // a topic that no recording of Rehearse has
};

/// The forms of all kinds but `other`, by kind.
std::span<const ChannelForm* const> channel_forms();

/// The form of a kind, which must not be `other`.
const ChannelForm& form_of(ChannelKind kind);

/// The first kind whose messages have this type; null: none.
const ChannelForm* form_of_type(std::string_view type);

/// An element of a message and its unit, which may be empty.
struct ChannelElement {
  std::string name;  // "position/x"
  std::string_view unit;
};

/// The elements of a kind with fixed elements, in the order of the message's fields.
const std::vector<ChannelElement>& elements_of(ChannelKind kind);

/// True if the channel has measurements of the device.
bool measures(const ChannelForm& form, const Device& device);

/// The inputs of devices by a robot's log, each once: numbers first, then pictures and ranges; by key.
std::span<const LogInput* const> log_inputs();
/// The first kind of channel with the input.
const ChannelForm& form_of_input(const LogInput& input);
/// The input that feeds the device, of several the first; null: it measures nothing.
const LogInput* log_input_of(const Device& device);
/// The fields of an input's messages that contain its numbers: "wrench/force/x", in the order of the kind's elements.
std::vector<std::string> fields_of(const LogInput& input);
/// True if messages of the input are measurements of the device.
bool feeds(const LogInput& input, const Device& device);

/// The kinds of the channels of a device, in their order.
std::vector<ChannelKind> kinds_of(const Device& device);

/// Index of the element of the first of the device's kinds that is its first value.
std::size_t first_element(const Device& device);
/// The elements of DeviceReading::values, by index.
std::span<const ChannelElement> value_elements(const Device& device);

/// The frame of the device's messages: BODY/DEVICE, or one beside it.
std::string frame_of(const std::string& body, const Device& device);
/// Null: the frame of its messages is the device frame.
const MessageFrame* message_frame(const Device& device);

}  // namespace rehearse
