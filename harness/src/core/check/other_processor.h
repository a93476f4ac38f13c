// Verdicts on a processor of another architecture than the golden's. Compilers and libraries for it round differently, so
// values are compared within tolerance, and the processor explains most differences as well as a change does. Internal.
#pragma once

#include <string>

#include "blame.h"

namespace rehearse {

/// The golden's processor architecture, and that of this process.
struct Architectures {
  std::string golden, here;
  static Architectures of(const Scenario& scenario, const Trace& golden);
};

/// The blame in words that hold on both processors; unchanged if both have one architecture, if all bits are equal, or
/// if the processor can't be the reason, as for a crash. `evidence`: the report with the levels that led to the blame.
Blame on_this_processor(Blame found, const CheckReport& evidence, const Architectures& architectures);

}  // namespace rehearse
