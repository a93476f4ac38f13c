// The library that reads meshes by assimp. It is loaded when the first file needs it, because assimp has five sixths of
// the addresses that the dynamic linker would set at the start of each program.
#pragma once

#include <rehearse/diagnostic.h>

#include <filesystem>

#include "mesh_file.h"
#include "mesh_format.h"
#include "mesh_input.h"

namespace rehearse {

/// The file of the library.
std::filesystem::path assimp_library();

/// Reads a mesh. Throws as assimp does. Fails also if the library can't be loaded.
Result<MeshReading> read_by_assimp(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                                   const MeshSelection& selection);

}  // namespace rehearse

/// The function of the library. False: `errors` states why nothing was read.
extern "C" bool rehearse_read_by_assimp(rehearse::MeshFormat format, rehearse::MeshInput& input,
                                        const Eigen::Vector3d& scale, const rehearse::MeshSelection& selection,
                                        rehearse::MeshReading& reading, rehearse::Diagnostics& errors);
