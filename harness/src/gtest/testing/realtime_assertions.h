// REHEARSE_REALTIME: every run of a test program has to be real-time safe.
#pragma once

#include <rehearse/gtest.h>
#include <rehearse/run_options.h>

#include <vector>

namespace rehearse::internal {

/// True if REHEARSE_REALTIME=1 is in the environment.
bool wants_realtime();

/// Fails for each controller that isn't real-time safe, or whose costs weren't counted. The message is lines.
TestVerdict judge_realtime(const std::vector<ControlTimes>& all);

}  // namespace rehearse::internal
