// ODE's messages during a step: they report that ODE found no solution and continues with an approximation.
#pragma once

#include <string>
#include <vector>

namespace rehearse {

/// The messages since the last call, each text once, the first 16: "ODE message 3: LCP internal error, s <= 0". ODE
/// doesn't report the world of a message, so call this after each step. Without messages a call is cheap.
std::vector<std::string> take_ode_messages();

}  // namespace rehearse
