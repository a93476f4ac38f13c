// Meshes in memory, each once: whoever has the same file at the same scale shares it, in whatever model or world.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include "convex_hull.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rehearse {

struct SharedMesh {
  std::shared_ptr<const MeshData> data;
  std::vector<std::string> warnings;  // those of its reading, each time anew
};

/// As read_mesh(), but a mesh that somebody still holds isn't read again, unless the size or the time of change of its
/// file is another. Keys are real paths, so that two files of one name stay two. May be called from any thread.
Result<SharedMesh> shared_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale);

/// What contact takes that mesh for: as convex_hulls(), shared in the same way.
Result<std::shared_ptr<const ConvexHulls>> shared_hulls(const std::filesystem::path& file,
                                                        const Eigen::Vector3d& scale);

/// How many meshes this process has read from files so far.
std::uint64_t meshes_read();

}  // namespace rehearse
