// Which meshes a model had, for the record.
#pragma once

#include <rehearse/model.h>

#include <string>

namespace rehearse {

/// A line for each mesh of the model, in the order of their first use: the digest of its bytes, two blanks, the file as
/// the model names it. Empty if it has none. Its meshes have to be loaded.
std::string mesh_digests(const Model& model);

}  // namespace rehearse
