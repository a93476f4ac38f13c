// The entries of `faults:` as a scenario's text states them, for reports on campaigns that vary them.
#pragma once

#include <rehearse/scenario.h>

#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct StatedFault {
  std::string owner;               // the kind of its part: sensor, encoder, actuator, link or controller
  std::string part, fault;         // as written: "RL_KNEE", "weak"
  std::string body;                // its name
  std::vector<std::string> paths;  // of the entry, as a path of `vary` may begin: "bodies.Dog.faults[0]."

  /// True if a path of `vary` is that of a key of this entry.
  bool contains(std::string_view path) const;
};

/// In the order of the text. Empty for a scenario that was made by a program, not from a file.
std::vector<StatedFault> stated_faults(const Scenario& scenario);

/// True unless faults of this kind ignore the key, as `dead` ignores `effort`.
bool fault_reads(std::string_view fault, std::string_view key);

}  // namespace rehearse
