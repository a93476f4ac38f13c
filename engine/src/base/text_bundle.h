// Texts of several files in one text, for recordings: the main text, then each part after a line
// `--- # rehearse file SIZE KEY`.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

/// The parts of a bundle by key, in order, the main text first under ""; nothing if the text is no bundle.
std::vector<std::pair<std::string, std::string>> parts_of_bundle(std::string_view text);

/// Adds a part to a bundle, which may be a main text alone.
void append_part(std::string& bundle, const std::string& key, const std::string& text);

}  // namespace rehearse
