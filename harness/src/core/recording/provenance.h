// Provenance: the versions and settings of a recording that its bits may depend on.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <string>

#include "core/host/controller_host.h"

namespace rehearse {

/// Versions of Rehearse, C library and compiler, processor, the pinning, seed and solver, and the controllers' files by
/// name and content; no controllers if `host` is null. `physics` and `renderer` describe themselves; empty: not used.
mcap::StringMap provenance(const Scenario& scenario, const ControllerHost* host, const std::string& physics,
                           const std::string& renderer);

/// The reason why the last bits of this process (`here`: its provenance()) may differ from the last bits of a recording
/// with the facts `recorded`: "libc was "glibc 2.36" and is ...". Empty: the bits are equal.
std::string other_arithmetic(const mcap::StringMap& recorded, const mcap::StringMap& here);

/// Only the controllers' files.
mcap::StringMap controller_facts(const ControllerHost& host);

/// A line for each mesh of the model and each texture of its materials, in the order of first use: the digest of its
/// bytes, two blanks, the name of the file in the model. Empty without meshes and textures. They must be loaded.
/// Heightmaps are left out: a recording contains their files.
std::string mesh_digests(const Model& model);

}  // namespace rehearse
