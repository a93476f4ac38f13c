// Changes of a scenario's text that leave all else, comments included, as written. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>

namespace rehearse {

/// The text with another value at a path, as in `vary:`. Fails if the scenario states nothing there. `file` is used in
/// messages.
Result<std::string> text_with(const std::string& text, const std::string& file, const std::string& path,
                              const std::string& value);

/// The text without a key of the scenario, from its line to that of the next key.
Result<std::string> text_without(const std::string& text, const std::string& file, const std::string& key);

}  // namespace rehearse
