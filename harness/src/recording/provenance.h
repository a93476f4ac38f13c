// Provenance: what a recording was made with, as far as its bits may depend on it.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <string>

#include "host/controller_host.h"

namespace rehearse {

/// Versions of Rehearse, C library and compiler, processor, what is pinned, seed and solver, and the controllers' files
/// by name and content; no controllers if `host` is null. `physics` and `renderer` describe themselves; empty: not used.
mcap::StringMap provenance(const Scenario& scenario, const ControllerHost* host, const std::string& physics,
                           const std::string& renderer);

/// Why the same program may give other last bits here (`here`: provenance() of this process) than where a recording
/// with the facts `recorded` was made: "libc was "glibc 2.36" and is ...". Empty: it gives the same.
std::string other_arithmetic(const mcap::StringMap& recorded, const mcap::StringMap& here);

/// Of these, the controllers' files.
mcap::StringMap controller_facts(const ControllerHost& host);

}  // namespace rehearse
