// The encodings of messages whose payloads can be decoded: a row each in message_format.cpp.
#pragma once

#include <rehearse/mcap.h>

#include <optional>
#include <string>
#include <string_view>

#include "ros2msg.h"

namespace rehearse::ros2msg {

/// True if a channel's payloads can be decoded: it has a schema, and both are written in known encodings.
bool is_decodable(std::string_view message_encoding, const mcap::Schema* schema);

/// The schema of a channel's payloads. `file` is the name of the schema's text in messages. Fails if it can't be read,
/// or with the reason why payloads of that encoding aren't decoded.
Result<Schema> schema_of(std::string_view message_encoding, const mcap::Schema& schema, std::string file = {});

/// The reason why a schema of a known encoding can't be read, as its first error; null: it can, or isn't examined.
std::optional<Diagnostic> problem_of(const mcap::Schema& schema);

}  // namespace rehearse::ros2msg
