// The history of tests (REHEARSE_HISTORY). Internal to the testing library.
#pragma once

#include <rehearse/check.h>
#include <rehearse/gtest.h>

#include <string>

namespace rehearse::internal {

/// Appends a line for an assertion of this test, if REHEARSE_HISTORY names a file. A line that can't be written fails
/// the assertion. Of the report, the verdict's codes, the expectations, the first difference and `proved` are used.
void keep_in_history(const std::string& test, const CheckReport& report, TestVerdict& verdict);

}  // namespace rehearse::internal
