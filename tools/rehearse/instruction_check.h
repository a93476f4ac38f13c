// check --instructions: the instructions of control() in replays of goldens, compared with those kept beside them.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <vector>

#include "command.h"

namespace rehearse::tool {

/// Counts and compares, one golden after the other. With REHEARSE_GOLDEN=new or accept the counts are kept instead.
/// Goldens without kept counts are left out. Exit::differs if a control() has grown; Exit::bad_input if nothing was
/// compared or kept.
Exit check_instructions(const std::vector<std::string>& goldens, AuditOptions options, bool json);

}  // namespace rehearse::tool
