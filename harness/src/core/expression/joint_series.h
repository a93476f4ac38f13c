// Finds the series of joints by the joints' names: q(KNEE) is Walker/KNEE/q. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The index of the name BODY/JOINT/QUANTITY, or of the command BODY/CONTROLLER/output/JOINT/QUANTITY. The joint is
/// given as BODY/JOINT or an ending of it.
Result<std::size_t> find_joint_name(std::string_view joint, std::string_view quantity, bool of_command,
                                    const std::vector<std::string>& names);

/// Names by which a recording may have the series that an expression calls so: the name itself, and those of the
/// position and the orientation of a link, for LINK/x and LINK/pitch.
std::vector<std::string> spellings_of(std::string_view series);

}  // namespace rehearse
