// Values of constants and defaults in schemas. Internal.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ros2msg.h"

namespace rehearse::ros2msg {

/// The reason why the text is no value of that type, as "'300' is no uint8"; empty if it is valid. `type` must not be a
/// message.
std::string literal_problem(const FieldType& type, std::string_view text);

/// The text; for a quoted string the text between the quotes.
std::string_view without_quotes(const FieldType& type, std::string_view text);

/// The text without blanks, tabs and carriage returns at its ends.
std::string_view trim(std::string_view text);

/// "uint8", "string".
std::string_view name_of(Primitive primitive);
/// The primitive of that name, `byte` and `char` included; nullopt if there is none.
std::optional<Primitive> find_primitive(std::string_view name);

}  // namespace rehearse::ros2msg
