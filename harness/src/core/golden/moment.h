// The present moment, written for people. No run depends on it. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <string>

namespace rehearse {

/// "2026-11-27T06:50:00Z", of SOURCE_DATE_EPOCH if the environment has it, as date_of_today() has.
Result<std::string> moment_of_now();

}  // namespace rehearse
