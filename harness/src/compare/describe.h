// A divergence in words, with a given text for its place. Internal.
#pragma once

#include <rehearse/compare.h>

#include <string>

namespace rehearse {

/// The text of the place ("tick 3 (0.003 s)"), then channel, element, expected and actual. `with_stage`: false for
/// files without ticks, where the stage has no meaning.
std::string describe(const Divergence& divergence, const std::string& place, bool with_stage);

}  // namespace rehearse
