// What is said of files that have to be whole, and are not. Internal.
#pragma once

#include <rehearse/diagnostic.h>

namespace rehearse::mcap {

/// The damage of a source, the first of it with what to do.
inline Diagnostics with_recover_hint(Diagnostics damage) {
  if (!damage.empty() && damage.front().hint.empty())
    damage.front().hint = "rehearse recover makes a whole file of what is there";
  return damage;
}

}  // namespace rehearse::mcap
