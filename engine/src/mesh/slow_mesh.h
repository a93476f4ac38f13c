// Sentences about meshes whose hulls take seconds to compute, for a person who waits.
#pragma once

#include <functional>
#include <string>

namespace rehearse {

/// From now on `tell` is called before the hulls of a large mesh are computed, with a sentence. It may be called from
/// any thread. At first nobody is told.
void on_slow_mesh(std::function<void(const std::string& sentence)> tell);

/// Calls the function that on_slow_mesh() has set.
void tell_slow_mesh(const std::string& sentence);

}  // namespace rehearse
