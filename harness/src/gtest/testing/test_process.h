// The process of tests. Internal.
#pragma once

#include <optional>

namespace rehearse::internal {

/// Must be called first in main(): pins the process, gives it a supervisor, and lets it fork a process for each run of
/// a test.
void begin_test_process(char** argv);

/// Must be called at the start of each test.
void begin_test();
/// How long the running test has taken [s]; none: begin_test() wasn't called, as another main() doesn't.
std::optional<double> seconds_of_test();

}  // namespace rehearse::internal
