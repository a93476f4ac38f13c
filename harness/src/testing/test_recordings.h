// The recordings of a test, and the folder of its goldens. Internal to the testing library.
#pragma once

#include <rehearse/golden.h>
#include <rehearse/trace.h>

#include <string>

namespace rehearse::internal {

GoldenStore golden_store();

/// The scenario file of a recording that this program made by record(); else empty.
std::string scenario_file_of(const Trace& trace);

}  // namespace rehearse::internal
