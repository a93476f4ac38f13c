// Digests of a model's meshes, for the recording.
#pragma once

#include <rehearse/model.h>

#include <string>

namespace rehearse {

/// A line for each mesh of the model, in the order of first use: the digest of its bytes, two blanks, the file as the
/// model names it. Empty if the model has no meshes. The meshes must be loaded.
std::string mesh_digests(const Model& model);

}  // namespace rehearse
