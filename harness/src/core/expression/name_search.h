// Finds names by their endings: KNEE/u is Walker/KNEE/u, if no other name has this ending. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// True if the name ends with the whole segments of `ending`, or is equal to it.
bool ends_with_segments(std::string_view name, std::string_view ending);

/// The index of the wanted name. `kind`: the kind of the names in messages, as "series".
Result<std::size_t> find_name(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

}  // namespace rehearse
