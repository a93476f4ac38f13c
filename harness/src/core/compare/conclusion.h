// The result of a comparison from its findings. Internal.
#pragma once

#include <rehearse/compare.h>

#include <vector>

namespace rehearse {

/// Sums up the findings of all channels.
void conclude(Comparison& comparison, std::vector<ChannelComparison> channels);
/// The result if nothing is compared, with the reason.
Comparison refusal(const Diagnostic& reason);

}  // namespace rehearse
