// Goldens that several scenarios name.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>
#include <vector>

namespace rehearse::tool {

/// An error if a different scenario names the same golden as one of these files, anywhere in the golden's repository:
/// each check would compare with the other scenario's run.
Result<void> check_owners(const std::vector<std::string>& files);

}  // namespace rehearse::tool
