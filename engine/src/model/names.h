// Suggestions for names that don't exist.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The names that are most similar to `wanted`, nearest first, at most three.
std::vector<std::string> near_names(std::string_view wanted, const std::vector<std::string>& names);

/// A hint for an unknown name: "did you mean 'a' or 'b'?", else the list of names: "known KIND: a, b, c".
std::string name_hint(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

}  // namespace rehearse
