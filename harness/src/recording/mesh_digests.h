// Digests of the files of a model's meshes and textures, for the recording.
#pragma once

#include <rehearse/model.h>

#include <string>

namespace rehearse {

/// A line for each mesh of the model and each texture of its materials, in the order of first use: the digest of its
/// bytes, two blanks, the name of the file in the model. Empty without meshes and textures. They must be loaded.
/// Heightmaps are left out: a recording contains their files.
std::string mesh_digests(const Model& model);

}  // namespace rehearse
