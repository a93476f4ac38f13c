// record --from-checkpoint: a branch of a recording.
#pragma once

#include <rehearse/session.h>

#include <CLI/App.hpp>
#include <string>

#include "command.h"

namespace rehearse::tool {

struct BranchSettings {
  std::string from;   // "TRACE@3.2s"; empty: not a branch
  std::string trace;  // empty: named like the source, in the working directory
  BranchOptions options;
};

/// Declares --from-checkpoint, --until, --set and --push.
void add_branch_options(CLI::App& options, BranchSettings& settings);
/// True if an option was given that has a meaning only with --from-checkpoint.
bool is_about_a_branch(const BranchSettings& settings);

Exit record_branch_of(BranchSettings settings);

}  // namespace rehearse::tool
