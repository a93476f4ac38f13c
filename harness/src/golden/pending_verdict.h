// The verdict of the check on a pending run, stored beside its trace. A person reads it before a decision. An
// acceptance writes it into the golden.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>

namespace rehearse {

/// Writes the verdict beside the trace, as NAME.verdict. Fails if it can't be written, or if the trace can't be read.
Result<void> keep_verdict(const std::filesystem::path& trace, const std::string& verdict);

/// The stored verdict. Empty: no check has judged this trace, byte by byte.
std::string kept_verdict(const std::filesystem::path& trace);

void remove_verdict(const std::filesystem::path& trace);

}  // namespace rehearse
