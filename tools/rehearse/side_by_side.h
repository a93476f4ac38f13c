// Work in several processes at once, whose output appears in order.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <functional>
#include <string>

#include "command.h"
#include "core/guard/worker_pool.h"

namespace rehearse::tool {

/// The number of processors that this process may use.
std::size_t processors();

/// The result of one part.
using MadePart = WorkerPool::Made;

/// Calls `work` for 0 to `count` - 1 in at most `jobs` supervised forks of this process. A fork works on one part after
/// the other, until one spoils it. The output of a part to stdout and stderr appears here when all parts before it are
/// finished. `take` gets its result just before. The first part that fails ends all: its errors are printed, and its
/// exit status is returned. A signal ends all parts. Must be called before this process has threads.
Exit work_side_by_side(std::size_t count, std::size_t jobs, const std::function<Result<MadePart>(std::size_t)>& work,
                       const std::function<void(const std::string&)>& take);

}  // namespace rehearse::tool
