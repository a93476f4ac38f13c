// What ODE has to say while it steps: that it found no solution, and goes on with what it has.
#pragma once

#include <string>
#include <vector>

namespace rehearse {

/// The messages since the last call, each text once, the first 16: "ODE message 3: LCP internal error, s <= 0". ODE
/// doesn't say of which world they are: to be asked after each step. Costs a look at an empty vector.
std::vector<std::string> take_ode_messages();

}  // namespace rehearse
