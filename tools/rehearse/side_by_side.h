// Work in several processes at once, whose output appears in order.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <functional>
#include <string>

#include "command.h"

namespace rehearse::tool {

/// The number of processors that this process may use.
std::size_t processors();

/// Calls `work` for 0 to `count` - 1, each in a process of its own, at most `jobs` at a time. The process is a
/// supervised fork of this one. Its output to stdout and stderr appears here when all parts before it are finished.
/// Then `take` gets the result of `work`. The first part that fails ends all: its errors are printed, and its exit
/// status is returned. A signal ends all parts. Must be called before this process has threads.
Exit work_side_by_side(std::size_t count, std::size_t jobs, const std::function<Result<std::string>(std::size_t)>& work,
                       const std::function<void(const std::string&)>& take);

}  // namespace rehearse::tool
