// The calls of controllers that take an unknown time, and the sentence about them.
#pragma once

#include <rehearse/audit.h>

#include <string>
#include <vector>

#include "call_log.h"

namespace rehearse {

/// The costs of a controller, with their places in its sources.
std::vector<AuditedCost> costs_in(const CallLog& log, const std::string& controller);

bool breaks_realtime(const ControllerAudit& controller);

/// "SR1/Walk is real-time safe in 10000 ticks: ...", or where it isn't. `complete`: the log has all kinds of calls.
std::string realtime_verdict(const AuditReport& report, bool complete);

}  // namespace rehearse
