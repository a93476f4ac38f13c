// The process of tests. Internal.
#pragma once

namespace rehearse::internal {

/// Must be called first in main(): pins the process, gives it a supervisor, and lets it fork a process for each run of
/// a test.
void begin_test_process(char** argv);

}  // namespace rehearse::internal
