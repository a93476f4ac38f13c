// Names by their endings: KNEE/u is Walker/KNEE/u, as long as no other ends so. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The name ends with the whole segments of `ending`, or is it.
bool ends_with_segments(std::string_view name, std::string_view ending);

/// The index of the name that is meant. `kind`: what messages call it, as "series".
Result<std::size_t> find_name(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

}  // namespace rehearse
