// Changes of a scenario's text that leave all else, comments included, as written. Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// The text with another value at a path, as in `vary:`. Fails if the scenario states nothing there. `file` is used in
/// messages.
Result<std::string> text_with(const std::string& text, const std::string& file, const std::string& path,
                              const std::string& value);

/// Scenario::load(), with other values at paths as in `vary:`; a path may also lead to a key with a default.
Result<Scenario> load_with(const std::filesystem::path& file,
                           const std::vector<std::pair<std::string, std::string>>& values);

/// The text without a key of the scenario, from its line to that of the next key.
Result<std::string> text_without(const std::string& text, const std::string& file, const std::string& key);

}  // namespace rehearse
