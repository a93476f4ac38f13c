// A divergence in words, wherever it is. Internal.
#pragma once

#include <rehearse/compare.h>

#include <string>

namespace rehearse {

/// Channel, element, expected and actual after the words for its place: "tick 3 (0.003 s)". Of files without ticks the
/// stage means nothing and is left out.
std::string describe(const Divergence& divergence, const std::string& place, bool with_stage);

}  // namespace rehearse
