// Mistakes in the form of a YAML file, in our words: indentation, brackets, dashes, colons. Private to the room.
#pragma once

#include <rehearse/diagnostic.h>

#include <string_view>

namespace rehearse {

/// Replaces the message, the hint and perhaps the place of a diagnostic about `text`, whose message is yaml-cpp's, by
/// those of the mistake behind it. An unknown message stays, with general advice.
void explain_yaml_mistake(std::string_view text, Diagnostic& diagnostic);

}  // namespace rehearse
