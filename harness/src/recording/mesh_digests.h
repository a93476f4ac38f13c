// Digests of the files of a model's meshes and textures, for the recording.
#pragma once

#include <rehearse/model.h>

#include <string>

namespace rehearse {

/// A line for each mesh of the model and each texture of its materials, in the order of first use: the digest of its
/// bytes, two blanks, the file as the model names it. Empty if the model has none. They must be loaded. Heightmaps are
/// left out: a recording contains their files.
std::string mesh_digests(const Model& model);

}  // namespace rehearse
