// A message as text: JSON for programs, a line for people. For all messages that a ros2msg schema describes.
//
// An object has the fields of the schema, in its order; a nested message is an object, an array or a sequence an array.
// Integers of 64 bits are written in full. A float is written with enough digits for a reader of doubles to get the
// same bits, a float32 as its double. It always has a point or an exponent, so -0.0 keeps its sign. JSON has no NaN and
// no infinities: they are the strings "NaN", "Infinity" and "-Infinity", and the payload of a NaN is lost. uint8 arrays
// and sequences of any length (also under their names byte[] and char[]) are strings in base64. Bytes of a string that
// aren't UTF-8 become U+FFFD.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/ros2msg/ros2msg.h"

namespace rehearse::ros2msg {

/// The message as one JSON object without a newline. Fails if the payload doesn't fit the schema, or if the text would
/// be longer than `max_size` [bytes].
Result<std::string> to_json(Decoder& decoder, std::span<const std::byte> payload,
                            std::size_t max_size = std::size_t{1} << 30);

/// The fields for people to read, in one line: for arrays the first few elements and the length, for bytes their
/// number. Fails as to_json().
Result<std::string> to_line(Decoder& decoder, std::span<const std::byte> payload);

}  // namespace rehearse::ros2msg

namespace rehearse {

/// Appends the text as a JSON string with its quotes.
void append_json(std::string& json, std::string_view text);
/// Appends the number as described above.
void append_json(std::string& json, double number);
/// Appends the bytes in base64 (RFC 4648, with padding), without quotes.
void append_base64(std::string& text, std::span<const std::byte> bytes);

}  // namespace rehearse
