// Lists of names in messages, and suggestions for names that don't exist.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// "a, b and 3 more": the first words, at most `most`, and the number of the others.
std::string listed(const std::vector<std::string>& words, std::size_t most);

/// The names that are most similar to `wanted`, nearest first, at most three.
std::vector<std::string> near_names(std::string_view wanted, const std::vector<std::string>& names);

/// A hint for an unknown name: "did you mean 'a' or 'b'?", else the list of names: "known KIND: a, b, c".
std::string name_hint(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

/// The text of name_hint() for an unknown name whose near_names() are `near`.
std::string near_hint(const std::vector<std::string>& near, const std::vector<std::string>& names,
                      std::string_view kind);

}  // namespace rehearse
