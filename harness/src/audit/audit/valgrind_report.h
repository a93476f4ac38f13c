// The errors that valgrind's memcheck found in the code of controllers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

/// A sentence for each kind of error and place, in the order of occurrence. Errors without a frame in one of the
/// libraries are left out. `xml`: the output of --xml=yes; an incomplete report is read up to its end.
std::vector<std::string> memory_errors_in(const std::string& xml, const std::vector<std::filesystem::path>& libraries);

}  // namespace rehearse
