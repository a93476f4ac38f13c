// Diagnostics for sources that must be whole, and are not. Internal.
#pragma once

#include <rehearse/diagnostic.h>

namespace rehearse::mcap {

/// The damage of a source; its first diagnostic gets the hint to recover the file.
inline Diagnostics with_recover_hint(Diagnostics damage) {
  if (!damage.empty() && damage.front().hint.empty())
    damage.front().hint = "rehearse recover makes a whole file of the undamaged data";
  return damage;
}

}  // namespace rehearse::mcap
