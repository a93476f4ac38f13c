// What valgrind's memcheck found in the code of controllers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// A sentence for each kind of error and place, in the order in which they occurred; errors without a frame in one of
/// the libraries are not the controllers'. `xml`: what --xml=yes writes; a report that ends early is read up to there.
std::vector<std::string> memory_errors_in(const std::string& xml, const std::vector<std::filesystem::path>& libraries);

}  // namespace rehearse
