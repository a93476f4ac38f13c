// replay --beside: two libraries of a controller with the same recorded inputs, in gdb (tools/gdb): the first number of
// their objects that differs, and the line that made the difference.
#pragma once

#include <rehearse/run_options.h>

#include <filesystem>
#include <string>

#include "command.h"

namespace rehearse::tool {

/// `beside`: OLD or NAME=OLD, a library, "recorded" or a commit of git. `host`: as for replay(); its library of the
/// same controller, else that of the recording, is the new one. `options`: those of the verb, for the programs that gdb
/// runs.
Exit replay_beside(const std::filesystem::path& trace, const std::string& beside, const HostOptions& host, bool json,
                   const CLI::App& options);

}  // namespace rehearse::tool
