// The formats of meshes that are read, and what of their bytes is looked at before assimp sees them: assimp takes many
// a truncated file for a whole one.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>

namespace rehearse {

enum class MeshFormat { stl, dae, obj, gltf, glb };

inline constexpr std::size_t max_mesh_triangles = 10'000'000;  // of a file

/// By the extension of the file's name, of any case.
Result<MeshFormat> mesh_format_of(const std::filesystem::path& file);

/// Refuses what is empty, a git-lfs pointer, or shorter than it says of itself, an OBJ with faces that can't be, and a
/// DAE with indices that aren't numbers. Brings into the form that assimp reads: an STL without what follows after its
/// last triangle, an OBJ without a byte order mark. A diagnostic has the line if it knows one.
Result<void> check_mesh_bytes(MeshFormat format, std::string& bytes);

/// True if an STL's bytes are binary: not if they merely begin with "solid", which many a binary one does.
bool is_binary_stl(const std::string& bytes);

}  // namespace rehearse
