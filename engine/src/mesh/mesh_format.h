// The supported mesh formats, and checks of a file's bytes before assimp reads them: assimp accepts many truncated
// files without an error.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>
#include <string>

namespace rehearse {

enum class MeshFormat { stl, dae, obj, gltf, glb, vrml };

inline constexpr std::size_t max_mesh_triangles = 10'000'000;  // of a file
inline constexpr std::size_t stl_head = 84;      // of a binary STL: header and number of triangles [bytes]
inline constexpr std::size_t stl_triangle = 50;  // of a binary STL [bytes]

/// The format by the extension of the file's name, in upper or lower case.
Result<MeshFormat> mesh_format_of(const std::filesystem::path& file);

/// Refuses an empty file, a git-lfs pointer, a file shorter than its header states, an OBJ with impossible faces, and a
/// DAE with indices that aren't numbers. Converts `bytes` to the form that assimp reads: removes bytes after the last
/// triangle of an STL and the byte order mark of an OBJ. A diagnostic contains the line if it is known.
Result<void> check_mesh_bytes(MeshFormat format, std::string& bytes);

/// True if an STL's bytes are binary. Many binary files begin with "solid", too, so that word doesn't decide.
bool is_binary_stl(const std::string& bytes);

}  // namespace rehearse
