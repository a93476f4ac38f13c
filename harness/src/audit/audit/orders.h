// Other orders of the threads of controllers: which of them change a command, and by which exchanges.
#pragma once

#include <rehearse/audit.h>

#include <functional>

#include "replay_process.h"

namespace rehearse {

/// Replays in AuditOptions::orders other orders, until one gives other commands or another end than the usual order.
/// That one is reduced to the fewest exchanges. Sets the verdict and the orders of the report. `take_first` is called
/// with the replay in the usual order. Fails as ReplayProcesses::run() does, or if the file of the order can't be
/// written.
Result<void> try_orders(ReplayProcesses& processes, const AuditOptions& options, AuditReport& report,
                        const std::function<void(const ReplayPass&)>& take_first);

}  // namespace rehearse
